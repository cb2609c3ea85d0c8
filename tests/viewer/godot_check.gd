# Loads the exported scene as a game does and says what is in it, as one line of JSON for godot_test.mjs.
#   godot3 --path FOLDER -s godot_check.gd [--blend=WEIGHTS.json]
# With --blend, draws ID_value() of each map over its texels and saves ID.png of each: needs a renderer.
extends SceneTree

var face
var arguments := {}


func _init() -> void:
	for argument in OS.get_cmdline_args():
		if argument.begins_with("--blend="):
			arguments.blend = argument.substr(8)
	face = load("res://face.tscn").instance()
	root.add_child(face)
	call_deferred("run")


func run() -> void:
	yield(self, "idle_frame")
	if arguments.has("blend"):
		yield(draw_maps(), "completed")
	else:
		print("RESULT ", to_json(describe()))
	quit()


func describe() -> Dictionary:
	var mesh: Mesh = face.mesh_instance.mesh
	var shapes := []
	for i in mesh.get_blend_shape_count():
		shapes.append(mesh.get_blend_shape_name(i))
	var material: ShaderMaterial = face.mesh_instance.get_surface_material(0)
	var uniforms := {}
	for entry in VisualServer.shader_get_param_list(material.shader.get_rid()):
		var value = material.get_shader_param(entry.name)
		uniforms[entry.name] = value.get_class() if value is Object else value
	var given := []  # what the shader gets for a few weights: layers and weights in use
	for weights in [{}, {0: 1.0}, {1: 0.25, 3: -0.5}]:
		for n in face.expressions.size():
			face.set_weight(face.expressions[n], weights.get(n, 0.0))
		face.update_textures()
		given.append(active(material))
	# An animation moves blend shapes itself; the textures follow.
	face.mesh_instance.set("blend_shapes/" + face.expressions[2], 0.75)
	face._process(0.0)
	given.append(active(material))
	var layers := {}
	for entry in ["albedo_differences", "normal_differences", "weights_0_0"]:  # of every package here
		var array: TextureArray = material.get_shader_param(entry)
		layers[entry] = [array.get_width(), array.get_height(), array.get_depth()]
	var surfaces := []
	for s in mesh.get_surface_count():
		var own: Material = face.mesh_instance.get_surface_material(s)
		surfaces.append((own if own != null else mesh.surface_get_material(s)).get_class())
	return {"shapes": shapes, "surfaces": surfaces, "expressions": face.expressions, "uniforms": uniforms, "given": given, "layers": layers,
		"half_uvs": (mesh.surface_get_format(0) & ArrayMesh.ARRAY_COMPRESS_TEX_UV) != 0}


func active(material: ShaderMaterial) -> Array:
	var image: Image = face._image
	var entries := []
	image.lock()
	for k in material.get_shader_param("facezip_count"):
		var entry := image.get_pixel(k, 0)
		entries.append([entry.r, entry.g])
	image.unlock()
	return entries


func draw_maps() -> void:
	var file := File.new()
	file.open(arguments.blend, File.READ)
	var request: Dictionary = parse_json(file.get_as_text())
	for expression in request.weights:
		face.set_weight(expression, request.weights[expression])
	face.update_textures()
	var source: ShaderMaterial = face.mesh_instance.get_surface_material(0)
	for map in request.maps:
		var viewport := Viewport.new()
		viewport.size = Vector2(map.width, map.height)
		viewport.usage = Viewport.USAGE_2D
		viewport.render_target_update_mode = Viewport.UPDATE_ALWAYS
		viewport.render_target_v_flip = true
		var sheet := ColorRect.new()
		sheet.rect_size = viewport.size
		sheet.material = source.duplicate()
		var code: String = source.shader.code
		code = code.substr(0, code.find("void fragment()"))
		code = code.replace("shader_type spatial;", "shader_type canvas_item;\nrender_mode blend_disabled, unshaded;")
		code += "void fragment() {\n  COLOR = vec4(%s_value(UV).rgb, 1.0);\n}\n" % map.name
		sheet.material.shader = Shader.new()
		sheet.material.shader.code = code
		viewport.add_child(sheet)
		root.add_child(viewport)
		yield(self, "idle_frame")
		yield(self, "idle_frame")
		yield(self, "idle_frame")
		viewport.get_texture().get_data().save_png(request.folder + "/" + map.name + ".png")
	# The demo as somebody sees it who runs the project.
	root.remove_child(face)
	root.add_child(load("res://demo.tscn").instance())
	for expression in request.weights:
		root.get_node("Demo/Face").set_weight(expression, request.weights[expression])
	for i in 5:
		yield(self, "idle_frame")
	var picture := root.get_texture().get_data()
	picture.flip_y()
	picture.save_png(request.folder + "/demo.png")
