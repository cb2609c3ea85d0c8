"""Blender loads a rig's glTF with its shape keys: blender --background --factory-startup --python-exit-code 1
--python rig_blender.py -- FILE.gltf"""
import json
import sys

import bpy
import numpy

# The importer of Blender 3.4 uses a name that NumPy dropped in 1.24; Debian 12 ships the two together.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

file = sys.argv[sys.argv.index("--") + 1]
with open(file, encoding="utf-8") as stream:
    gltf = json.load(stream)
expected = gltf["meshes"][0]["extras"]["targetNames"]
bpy.ops.import_scene.gltf(filepath=file)
found = [mesh for mesh in bpy.data.meshes if mesh.shape_keys]
assert len(found) == 1, "one mesh with shape keys"
keys = list(found[0].shape_keys.key_blocks)
assert [key.name for key in keys[1:]] == expected, "names of the shape keys"
for key, target in zip(keys[1:], gltf["meshes"][0]["primitives"][0]["targets"]):
    # The file says how far each shape moves; Blender's axes differ, lengths do not.
    accessor = gltf["accessors"][target["POSITION"]]
    reach = max(abs(value) for value in accessor["min"] + accessor["max"])
    moved = max(max(abs(a - b) for a, b in zip(p.co, q.co)) for p, q in zip(key.data, keys[0].data))
    assert abs(moved - reach) <= 1e-5, f"{key.name} moves {moved} m, not {reach}"
assert bpy.data.images, "the neutral texture"
print("Blender", bpy.app.version_string, "loads", len(expected), "shape keys")
