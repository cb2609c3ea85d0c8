# facezip_face.gd - the textures of a face follow its blend shapes (Godot 3.2 and later 3.x).
#
# Animate the blend shapes of the MeshInstance under Head as in any scene, or call set_weight("smile", 0.7). Expressions
# that have no blend shape are set by set_weight() alone.
tool
extends Spatial

export(Material) var material
export(PoolStringArray) var expressions  # in the order of the layers of the weight maps

var mesh_instance: MeshInstance
var _extra := {}  # weights of expressions without a blend shape
var _blend_shapes := {}  # expression -> property of the MeshInstance
var _shown := []
var _image := Image.new()
var _texture := ImageTexture.new()
var _material: ShaderMaterial


func _ready() -> void:
	mesh_instance = _find_mesh(self)
	var present := {}
	for property in mesh_instance.get_property_list():
		present[property.name] = true
	for expression in expressions:
		if present.has("blend_shapes/" + expression):
			_blend_shapes[expression] = "blend_shapes/" + expression
	_image.create(expressions.size(), 1, false, Image.FORMAT_RGF)
	_texture.create_from_image(_image, 0)
	_material = material.duplicate()  # every face has weights of its own
	_material.set_shader_param("facezip_active", _texture)
	mesh_instance.set_surface_material(0, _material)  # the skin; eyes, teeth and lashes are surfaces of their own
	update_textures()


func _process(_delta: float) -> void:
	update_textures()


# Poses mesh and textures. Weights of any sign and size are taken, as animations have them.
func set_weight(expression: String, weight: float) -> void:
	if _blend_shapes.has(expression):
		mesh_instance.set(_blend_shapes[expression], weight)
	elif expression in expressions:
		_extra[expression] = weight
	else:
		push_error("facezip: no expression \"%s\"" % expression)


func get_weight(expression: String) -> float:
	if _blend_shapes.has(expression):
		return mesh_instance.get(_blend_shapes[expression])
	return _extra.get(expression, 0.0)


# The material of this face, for parameters of your own.
func get_material() -> ShaderMaterial:
	return _material


# Gives the shader the weights that are not 0. Runs each frame; costs nothing where none changed.
func update_textures() -> void:
	var weights := []
	for expression in expressions:
		weights.append(get_weight(expression))
	if weights == _shown:
		return
	_shown = weights
	var count := 0
	_image.lock()
	for n in weights.size():
		if weights[n] != 0.0:
			_image.set_pixel(count, 0, Color(n, weights[n], 0.0))
			count += 1
	_image.unlock()
	_texture.set_data(_image)
	_material.set_shader_param("facezip_count", count)


func _find_mesh(node: Node) -> MeshInstance:
	for child in node.get_children():
		if child is MeshInstance and child.mesh != null:
			return child
		var found := _find_mesh(child)
		if found != null:
			return found
	return null
