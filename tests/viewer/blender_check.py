"""What facezip_blender.py gives to shading: blender --background --factory-startup --python-exit-code 1
--python blender_check.py -- FOLDER WEIGHTS FILE.exr bakes the base colour of the exported FOLDER into FILE.exr."""
import json
import os
import runpy
import sys

import bpy

folder, weights, file = sys.argv[sys.argv.index("--") + 1:]
script = runpy.run_path(os.path.join(folder, "facezip_blender.py"))

# Blender 4.0 renamed an input of the shader; collections of inputs are asked like dictionaries.
names = ("Specular IOR Level", "Specular")
assert script["first_of"]({"Specular": "before"}, *names) == "before"
assert script["first_of"]({"Specular IOR Level": "since", "Specular Tint": "other"}, *names) == "since"

with open(os.path.join(folder, "package", "package.json"), encoding="utf-8") as stream:
    package = json.load(stream)
face, graph, values, controls = script["build"](package)
# The factory scene is gone: its cube would hide the head, its camera stand inside.
assert {o.type for o in bpy.context.scene.objects} == {"MESH", "CAMERA", "LIGHT"}, list(bpy.context.scene.objects)
assert [o for o in bpy.context.scene.objects if o.type == "MESH"] == [face]
script["set_weights"](face, controls, weights)
shader = next(node for node in graph.tree.nodes if node.type == "BSDF_PRINCIPLED")
specular = [shader.inputs[name].default_value for name in names if name in shader.inputs]
assert abs(specular[0] - 0.35) < 1e-6, specular
albedo = next(m["name"] for m in package["maps"] if "albedo" in m["name"])
base_colour = shader.inputs["Base Color"].links[0].from_socket
script["bake"](face, graph, package, {albedo: base_colour}, f"{albedo}={file}")
print("Blender", bpy.app.version_string, "bakes the base colour")
