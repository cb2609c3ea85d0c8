"""Exports a capture's meshes as Blender does: blender --background --factory-startup --python-exit-code 1
--python capture_blender.py -- CAPTURE FILE.glb FILE.fbx"""

import pathlib
import sys

import bpy

capture, glb, fbx = sys.argv[sys.argv.index("--") + 1:]
capture = pathlib.Path(capture)


def read(file):
    rows = {"v": [], "vt": [], "f": []}
    for line in file.read_text().splitlines():
        words = line.split()
        if words and words[0] in rows:
            rows[words[0]].append(words[1:])
    corners = [[tuple(int(part) - 1 for part in corner.split("/")[:2]) for corner in face] for face in rows["f"]]
    return [tuple(map(float, v[:3])) for v in rows["v"]], [tuple(map(float, uv[:2])) for uv in rows["vt"]], corners


bpy.ops.wm.read_factory_settings(use_empty=True)
positions, uvs, faces = read(capture / "neutral.obj")
mesh = bpy.data.meshes.new("head")
mesh.from_pydata(positions, [], [[corner[0] for corner in face] for face in faces])
layer = mesh.uv_layers.new(name="UVMap")
for loop, corner in zip(layer.data, [corner for face in faces for corner in face]):
    loop.uv = uvs[corner[1]]
head = bpy.data.objects.new("head", mesh)
bpy.context.collection.objects.link(head)
head.shape_key_add(name="Basis")
for file in sorted((capture / "expressions").glob("*.obj")):
    key = head.shape_key_add(name=file.stem)
    for point, position in zip(key.data, read(file)[0]):
        point.co = position
bpy.ops.export_scene.gltf(filepath=glb, export_format="GLB")
bpy.ops.export_scene.fbx(filepath=fbx)
