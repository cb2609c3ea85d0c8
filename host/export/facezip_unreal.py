# facezip_unreal.py - imports the face of this folder into an Unreal project and builds its material.
# In the editor, with the plug-ins Python Editor Script Plugin and Interchange: File > Execute Python Script.
import json
import os

import unreal

HERE = os.path.dirname(os.path.abspath(__file__))
OUTPUTS = {1: "CMOT_FLOAT1", 3: "CMOT_FLOAT3", 4: "CMOT_FLOAT4"}


def import_files(files, destination):
    tasks = []
    for file in files:
        task = unreal.AssetImportTask()
        task.filename = file
        task.destination_path = destination
        task.automated = True
        task.replace_existing = True
        task.save = True
        tasks.append(task)
    unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks(tasks)


def keep_samples(texture, weights, compression):
    """Samples as they are stored: the material converts what it has blended. What was in blocks is coded again."""
    for name, value in (("srgb", False),
                        ("compression_settings", getattr(unreal.TextureCompressionSettings, compression)),
                        ("address_x", unreal.TextureAddress.TA_CLAMP),
                        ("address_y", unreal.TextureAddress.TA_CLAMP),
                        ("flip_green_channel", False)):
        texture.set_editor_property(name, value)
    if weights:  # read texel by texel, at their full size
        texture.set_editor_property("mip_gen_settings", unreal.TextureMipGenSettings.TMGS_NO_MIPMAPS)
        texture.set_editor_property("filter", unreal.TextureFilter.TF_NEAREST)
        texture.set_editor_property("never_stream", True)


def custom_input(name):
    made = unreal.CustomInput()
    made.set_editor_property("input_name", name)
    return made


def build_material(face, destination):
    edit = unreal.MaterialEditingLibrary
    tools = unreal.AssetToolsHelpers.get_asset_tools()
    path = f"{destination}/M_FaceZip"
    if unreal.EditorAssetLibrary.does_asset_exist(path):
        unreal.EditorAssetLibrary.delete_asset(path)
    material = tools.create_asset("M_FaceZip", destination, unreal.Material, unreal.MaterialFactoryNew())
    material.set_editor_property("used_with_skeletal_mesh", True)
    material.set_editor_property("used_with_morph_targets", True)
    with open(os.path.join(HERE, "FaceZip.ush"), encoding="utf-8") as file:
        blend = file.read()
    uv = edit.create_material_expression(material, unreal.MaterialExpressionTextureCoordinate, -900, -200)
    betas = []
    for n, name in enumerate(face["expressions"]):
        beta = edit.create_material_expression(material, unreal.MaterialExpressionScalarParameter, -900, 80 * n)
        beta.set_editor_property("parameter_name", name)
        beta.set_editor_property("default_value", 0.0)
        betas.append(beta)
    textures = {}
    for row, node in enumerate(face["nodes"]):
        with open(os.path.join(HERE, node["code"]), encoding="utf-8") as file:
            code = blend + file.read()
        custom = edit.create_material_expression(material, unreal.MaterialExpressionCustom, -300, 400 * row)
        names = ["uv"] + node["textures"] + [f"beta_{n}" for n in range(len(betas))]
        custom.set_editor_property("inputs", [custom_input(name) for name in names])
        custom.set_editor_property("code", code)
        custom.set_editor_property("description", f"facezip {node['map']}")
        custom.set_editor_property("output_type", getattr(unreal.CustomMaterialOutputType, OUTPUTS[node["floats"]]))
        edit.connect_material_expressions(uv, "", custom, "uv")
        for name in node["textures"]:
            if name not in textures:
                made = edit.create_material_expression(material, unreal.MaterialExpressionTextureObject, -1300, 260 * len(textures))
                made.set_editor_property("texture", unreal.EditorAssetLibrary.load_asset(f"{destination}/{name}"))
                made.set_editor_property("sampler_type", unreal.MaterialSamplerType.SAMPLERTYPE_LINEAR_COLOR)
                textures[name] = made
            edit.connect_material_expressions(textures[name], "", custom, name)
        for n, beta in enumerate(betas):
            edit.connect_material_expressions(beta, "", custom, f"beta_{n}")
        if node["property"]:
            edit.connect_material_property(custom, "", getattr(unreal.MaterialProperty, node["property"]))
    edit.recompile_material(material)
    unreal.EditorAssetLibrary.save_loaded_asset(material)
    return material


def main():
    with open(os.path.join(HERE, "FaceZip.json"), encoding="utf-8") as file:
        face = json.load(file)
    plain = "".join(c if c.isascii() and c.isalnum() else "_" for c in face["name"]) or "Face"
    destination = f"/Game/FaceZip/{plain}"
    names = sorted({name for node in face["nodes"] for name in node["textures"]})
    import_files([os.path.join(HERE, "textures", f"{name}.png") for name in names], destination)
    for name in names:
        texture = unreal.EditorAssetLibrary.load_asset(f"{destination}/{name}")
        if texture is None:
            raise RuntimeError(f"facezip: {name}.png was not imported")
        keep_samples(texture, name.startswith("weights_"), face["compression"].get(name, "TC_VECTOR_DISPLACEMENTMAP"))
        unreal.EditorAssetLibrary.save_loaded_asset(texture)
    import_files([os.path.join(HERE, "scene.gltf")], destination)
    build_material(face, destination)
    unreal.log(f"facezip: {destination} holds the mesh and M_FaceZip; give the mesh this material")


main()
