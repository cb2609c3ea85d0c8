# facezip_blender.py - builds the face of this folder in Blender (3.4 and later): mesh with shape keys, and a material that
# blends the package's textures by the same shape keys (docs/blend.md of facezip).
#
# In Blender: Scripting > Open > Run. Headless:
#   blender --background --factory-startup --python facezip_blender.py -- [--weights smile=0.7,jawOpen=0.2]
#           [--bake MAP=FILE.exr] [--render FILE.png] [--save FILE.blend]
import json
import os
import sys

import bpy
import numpy

# The glTF importer of Blender 3.4 uses names that numpy 1.24 dropped (Debian 12 has both).
for name, kind in (("bool", bool), ("int", int), ("float", float), ("object", object)):
    if name not in numpy.__dict__:
        setattr(numpy, name, kind)

HERE = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else bpy.path.abspath("//")


class Graph:
    """Nodes of one material; values are sockets."""

    def __init__(self, tree):
        self.tree = tree

    def node(self, kind, **settings):
        made = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(made, name, value)
        return made

    def put(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def math(self, operation, *values):
        made = self.node("ShaderNodeMath", operation=operation)
        for socket, value in zip(made.inputs, values):
            self.put(socket, value)
        return made.outputs[0]

    def vector(self, operation, *values):
        made = self.node("ShaderNodeVectorMath", operation=operation)
        for socket, value in zip(made.inputs, values):
            self.put(socket, (value,) * 3 if isinstance(value, float) else value)
        return made.outputs[0]

    def combine(self, *values):
        made = self.node("ShaderNodeCombineXYZ")
        for socket, value in zip(made.inputs, values):
            self.put(socket, value)
        return made.outputs[0]

    def separate(self, value):
        made = self.node("ShaderNodeSeparateXYZ")
        self.put(made.inputs[0], value)
        return made.outputs

    def image(self, name, uv, interpolation):
        made = self.node("ShaderNodeTexImage", image=load_image(name), interpolation=interpolation, extension="EXTEND")
        self.put(made.inputs[0], uv)
        return made.outputs  # Color, Alpha


def load_image(name):
    image = bpy.data.images.load(os.path.join(HERE, "package", name), check_existing=True)
    image.colorspace_settings.name = "Non-Color"  # samples as they are stored
    image.alpha_mode = "CHANNEL_PACKED"  # alpha is a number like the others
    return image


def cell_coordinates(graph, uv, blend_map, weights):
    """Where a texel lies in cells, and that as atlas UV of tile (0, 0). Blender's v runs up, rows run down."""
    x, y, _ = graph.separate(uv)

    def cell(position, size, cells):
        at = graph.math("MULTIPLY_ADD", position, size / blend_map["weight_scale"], -0.5)
        return graph.math("MINIMUM", graph.math("MAXIMUM", at, 0.0), cells - 1.0)

    u = cell(x, blend_map["width"], weights["tile_width"])
    v = cell(graph.math("SUBTRACT", 1.0, y), blend_map["height"], weights["tile_height"])
    atlas = (weights["columns"] * (weights["tile_width"] + 2), weights["rows"] * (weights["tile_height"] + 2))
    return graph.combine(graph.math("MULTIPLY_ADD", u, 1.0 / atlas[0], 1.5 / atlas[0]),
                         graph.math("MULTIPLY_ADD", v, -1.0 / atlas[1], 1.0 - 1.5 / atlas[1]), 0.0), atlas


def blended_weights(graph, uv, package, blend_map, betas):
    """w_i of the map, C sockets: Eq. 8's bracket."""
    weights = package["weights"][blend_map["weights"]]
    base, atlas = cell_coordinates(graph, uv, blend_map, weights)
    beta_sum = betas[0]
    for beta in betas[1:]:
        beta_sum = graph.math("ADD", beta_sum, beta)
    sockets = []
    for number, file in enumerate(weights["files"]):
        channels = min(4, package["differences"] - 4 * number)
        colour, alpha = (0.0, 0.0, 0.0), 0.0
        for n, beta in enumerate(betas):
            tile = (n % weights["columns"], n // weights["columns"])
            shift = (tile[0] * (weights["tile_width"] + 2) / atlas[0], -tile[1] * (weights["tile_height"] + 2) / atlas[1], 0.0)
            sample = graph.image(file, graph.vector("ADD", base, shift), "Linear")
            colour = graph.vector("MULTIPLY_ADD", sample[0], graph.combine(beta, beta, beta), colour)
            if channels in (2, 4):
                alpha = graph.math("MULTIPLY_ADD", sample[1], beta, alpha)
        parts = list(graph.separate(colour)) + [alpha]
        if channels == 2:  # gray and alpha
            parts[1] = alpha
        for c in range(channels):
            i = 4 * number + c
            offset = graph.math("MULTIPLY", beta_sum, weights["offset"][i])
            sockets.append(graph.math("MULTIPLY_ADD", parts[c], 255.0 * weights["scale"][i], offset))
    return sockets


def blended_map(graph, uv, package, blend_map, betas):
    """T of the map as a vector, samples as they are stored."""
    value = graph.image(blend_map["neutral"]["file"], uv, "Linear")[0]
    most = 2 ** blend_map["difference_bits"] - 1
    for difference, weight in zip(blend_map["differences"], blended_weights(graph, uv, package, blend_map, betas)):
        def channels(function):
            values = [function(s, o) for s, o in zip(difference["scale"], difference["offset"])]
            return (values[0],) * 3 if len(values) < 3 else tuple(values[:3])  # gray comes as three, alpha apart

        zero = channels(lambda s, o: round(-o / s) / most if s > 0 else 0.0)
        scale = channels(lambda s, o: s * most / 255.0)
        code = graph.image(difference["file"], uv, "Linear")[0]
        change = graph.vector("MULTIPLY", graph.vector("SUBTRACT", code, zero), scale)
        value = graph.vector("MULTIPLY_ADD", change, graph.combine(weight, weight, weight), value)
    return value


def to_linear(graph, value):
    """sRGB to linear light, channel by channel."""
    def channel(c):
        low = graph.math("MULTIPLY", c, 1.0 / 12.92)
        high = graph.math("POWER", graph.math("MAXIMUM", graph.math("MULTIPLY_ADD", c, 1.0 / 1.055, 0.055 / 1.055), 0.0), 2.4)
        chosen = graph.math("GREATER_THAN", c, 0.04045)
        return graph.math("MULTIPLY_ADD", graph.math("SUBTRACT", high, low), chosen, low)

    return graph.combine(*[channel(c) for c in graph.separate(value)])


def short_name(name, taken):
    """A name that Blender holds whole, at most 63 bytes, and none of `taken`: cut, .001 and so on where the rest is the
    same, as the importer of glTF names shape keys."""
    for number in range(len(taken) + 1):
        suffix = f".{number:03}" if number else ""
        short = name.encode()[:63 - len(suffix)].decode(errors="ignore") + suffix
        if short not in taken:
            return short


def controls_of(face, names):
    """What moves every expression, by its whole name: a shape key where there is one, else the name of a property of the
    object. Says which names were shortened."""
    with open(os.path.join(HERE, "scene.gltf"), encoding="utf-8") as file:
        targets = json.load(file)["meshes"][0].get("extras", {}).get("targetNames", [])
    keys = face.data.shape_keys.key_blocks[1:] if targets else []  # in the order of the file, after the basis
    controls = {name: key for name, key in zip(targets, keys) if name in names}
    properties = set()
    for name in names:
        if name not in controls:
            controls[name] = short_name(name, properties)
            properties.add(controls[name])
            face[controls[name]] = 0.0
        control = controls[name]
        short = control if isinstance(control, str) else control.name
        if short != name:
            print(f"facezip_blender.py: in Blender, {name} is called {short}")
    return controls


def beta_nodes(graph, face, names, controls):
    """A value for every expression, driven by what moves it."""
    sockets = []
    for name in names:
        made = graph.node("ShaderNodeValue", label=name)
        curve = made.outputs[0].driver_add("default_value")
        curve.driver.type = "AVERAGE"
        target = curve.driver.variables.new().targets[0]
        control = controls[name]
        if isinstance(control, str):
            target.id = face
            target.data_path = f'["{bpy.utils.escape_identifier(control)}"]'
        else:
            target.id_type, target.id = "KEY", face.data.shape_keys
            target.data_path = f'key_blocks["{bpy.utils.escape_identifier(control.name)}"].value'
        sockets.append(made.outputs[0])
    return sockets


def first_of(inputs, *names):
    """The input that has one of the names: Blender renames them."""
    return inputs[next(name for name in names if name in inputs)]


def roles_of_maps():
    """What maps are in a physical material, by their names: as facezip says in the scene."""
    with open(os.path.join(HERE, "scene.gltf"), encoding="utf-8") as file:
        roles = json.load(file)["materials"][0]["extras"]["facezip"]["roles"]
    return {name: role for role, name in roles.items()}


# What Blender starts with: a cube of two metres, around the head, a camera in its middle, and a lamp.
FACTORY_OBJECTS = {"Cube": "MESH", "Camera": "CAMERA", "Light": "LIGHT"}


def clear_factory_scene():
    """Takes the objects of an untouched factory scene away; a scene of somebody's own stays as it is."""
    objects = bpy.context.scene.objects
    if bpy.data.filepath or {o.name: o.type for o in objects} != FACTORY_OBJECTS:
        return
    for made in list(objects):
        bpy.data.objects.remove(made, do_unlink=True)


def set_stage(face):
    """A camera before the face and a sun, where the scene has none: what is rendered then shows the face."""
    from mathutils import Vector

    scene = bpy.context.scene
    if scene.camera is None:
        corners = [face.matrix_world @ Vector(c) for c in face.bound_box]
        centre = sum(corners, Vector()) / 8
        size = max((c - centre).length for c in corners)
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        camera.location = centre + Vector((0, -4.2 * size, 0))
        camera.rotation_euler = (1.5708, 0, 0)
        camera.data.clip_start = size / 100
        camera.data.clip_end = 100 * size
        scene.collection.objects.link(camera)
        scene.camera = camera
    if not any(o.type == "LIGHT" for o in scene.objects):
        sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
        sun.data.energy = 3
        sun.rotation_euler = (0.9, 0.3, 0.4)
        scene.collection.objects.link(sun)


def build(package):
    clear_factory_scene()
    bpy.ops.import_scene.gltf(filepath=os.path.join(HERE, "scene.gltf"))
    face = next(o for o in bpy.context.selected_objects if o.type == "MESH")
    material = bpy.data.materials.new(package["name"] or "face")
    material.use_nodes = True
    face.data.materials[0] = material  # the skin's; eyes, teeth and lashes keep theirs
    graph = Graph(material.node_tree)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.5
    first_of(shader.inputs, "Specular IOR Level", "Specular").default_value = 0.35  # since Blender 4.0; before
    uv = graph.node("ShaderNodeUVMap").outputs[0]
    controls = controls_of(face, package["expressions"])
    betas = beta_nodes(graph, face, package["expressions"], controls)
    values, roles = {}, roles_of_maps()
    for blend_map in package["maps"]:
        if not blend_map["neutral"]["file"].endswith(".png"):
            continue
        value = values[blend_map["name"]] = blended_map(graph, uv, package, blend_map, betas)
        role = roles.get(blend_map["name"])
        if role == "albedo":
            linear = blend_map["colour_space"] == "linear"
            graph.put(shader.inputs["Base Color"], value if linear else to_linear(graph, value))
        elif role == "normal":
            normal = graph.node("ShaderNodeNormalMap")
            graph.put(normal.inputs["Color"], value)
            graph.put(shader.inputs["Normal"], normal.outputs[0])
        elif role == "roughness":
            graph.put(shader.inputs["Roughness"], graph.separate(value)[0])
    set_stage(face)
    return face, graph, values, controls


def set_weights(face, controls, text):
    for part in filter(None, (text or "").split(",")):
        name, _, value = part.rpartition("=")  # names may hold some, too
        control = controls.get(name)
        if control is None:
            raise SystemExit(f"facezip_blender.py: no expression {name}")
        if isinstance(control, str):
            face[control] = float(value)
        else:
            control.slider_min = -10
            control.slider_max = 10
            control.value = float(value)
    bpy.context.view_layer.update()


def bake(face, graph, package, values, request):
    """Writes T of one map, unclamped, in the layout of the texture."""
    name, file = request.split("=", 1)
    blend_map = next(m for m in package["maps"] if m["name"] == name)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False  # Debian builds without a denoiser
    scene.cycles.device = "CPU"
    scene.render.bake.margin = 0
    nodes = graph.tree.nodes
    for node in nodes:  # texels themselves, wherever in them the baker looks
        if node.type == "TEX_IMAGE" and "weights" not in node.image.name:
            node.interpolation = "Closest"
    emission = graph.node("ShaderNodeEmission")
    graph.put(emission.inputs[0], values[name])
    output = next(n for n in nodes if n.type == "OUTPUT_MATERIAL")
    graph.tree.links.new(emission.outputs[0], output.inputs[0])
    target = bpy.data.images.new("bake", blend_map["width"], blend_map["height"], alpha=True, float_buffer=True)
    target.colorspace_settings.name = "Non-Color"
    target.generated_color = (0, 0, 0, 0)
    node = graph.node("ShaderNodeTexImage", image=target)
    nodes.active = node
    # Parts beyond the skin would be drawn over it: they go elsewhere.
    scrap = bpy.data.images.new("scrap", 4, 4)
    aside = []
    for slot in list(face.material_slots)[1:]:
        others = slot.material.node_tree.nodes
        others.active = others.new("ShaderNodeTexImage")
        others.active.image = scrap
        aside.append((others, others.active))
    bpy.ops.object.select_all(action="DESELECT")
    face.select_set(True)
    bpy.context.view_layer.objects.active = face
    bpy.ops.object.bake(type="EMIT", margin=0)
    for others, made in aside:
        others.remove(made)
    bpy.data.images.remove(scrap)
    target.filepath_raw = file
    target.file_format = "OPEN_EXR"
    target.save()
    graph.tree.links.new(nodes["Principled BSDF"].outputs[0], output.inputs[0])


def render(file):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False  # Debian builds without a denoiser
    scene.render.resolution_x = scene.render.resolution_y = 256
    scene.render.filepath = file
    bpy.ops.render.render(write_still=True)


def main(arguments):
    options = dict(zip(arguments[0::2], arguments[1::2]))
    unknown = set(options) - {"--weights", "--bake", "--render", "--save"}
    if unknown or len(arguments) % 2:
        raise SystemExit(f"facezip_blender.py: unknown option {' '.join(unknown) or arguments[-1]}")
    with open(os.path.join(HERE, "package", "package.json"), encoding="utf-8") as file:
        package = json.load(file)
    face, graph, values, controls = build(package)
    set_weights(face, controls, options.get("--weights"))
    if "--bake" in options:
        bake(face, graph, package, values, options["--bake"])
    if "--render" in options:
        render(options["--render"])
    if "--save" in options:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(options["--save"]))


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
