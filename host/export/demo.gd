# demo.gd - the face with a slider for each expression. Drag to turn it. A start, not a part of facezip_face.gd.
extends Spatial


func _ready() -> void:
	var bounds: AABB = $Face.mesh_instance.get_transformed_aabb()
	var centre := bounds.position + 0.5 * bounds.size
	$Face.transform.origin = -centre
	$Camera.transform.origin = Vector3(0, 0, 1.6 * bounds.size.length())
	$Camera.near = 0.01 * bounds.size.length()
	$Camera.far = 100.0 * bounds.size.length()
	var environment := Environment.new()
	environment.background_mode = Environment.BG_COLOR
	environment.background_color = Color(0.12, 0.13, 0.14)
	environment.ambient_light_color = Color.white
	environment.ambient_light_energy = 0.35
	$Camera.environment = environment
	var scroll := ScrollContainer.new()
	scroll.rect_min_size = Vector2(300, get_viewport().size.y)
	add_child(scroll)
	var list := VBoxContainer.new()
	scroll.add_child(list)
	for expression in $Face.expressions:
		list.add_child(_slider(expression))


func _slider(expression: String) -> HBoxContainer:
	var row := HBoxContainer.new()
	var label := Label.new()
	label.text = expression
	label.rect_min_size.x = 160
	var slider := HSlider.new()
	slider.rect_min_size = Vector2(120, 20)
	slider.max_value = 1.0
	slider.step = 0.01
	slider.connect("value_changed", self, "_on_value_changed", [expression])
	row.add_child(label)
	row.add_child(slider)
	return row


func _on_value_changed(value: float, expression: String) -> void:
	$Face.set_weight(expression, value)


func _unhandled_input(event: InputEvent) -> void:
	if event is InputEventMouseMotion and event.button_mask & BUTTON_MASK_LEFT:
		var centre: Vector3 = $Face.transform.origin
		$Face.transform = Transform(Basis(Vector3.UP, 0.01 * event.relative.x), Vector3.ZERO) * $Face.transform
