// FaceZipImport.cs - imports the textures of faces as they are, and makes their materials: Assets > FaceZip > Make Material.
#if UNITY_EDITOR
using System;
using System.IO;
using UnityEditor;
using UnityEngine;

/// Textures in blocks: KTX2 files under a name of their own, which no other importer asks for. The blocks become the texture as they are.
[UnityEditor.AssetImporters.ScriptedImporter(1, "fzktx2")]
public sealed class FaceZipBlocks : UnityEditor.AssetImporters.ScriptedImporter
{
    public override void OnImportAsset(UnityEditor.AssetImporters.AssetImportContext context)
    {
        byte[] file = File.ReadAllBytes(context.assetPath);
        int levels = BitConverter.ToInt32(file, 40);
        int bytes = 0;
        for (int level = 0; level < levels; ++level) bytes += LengthOf(file, level);
        var blocks = new byte[bytes];  // Unity wants the largest level first; KTX2 stores it last
        int at = 0;
        for (int level = 0; level < levels; ++level)
        {
            Array.Copy(file, BitConverter.ToInt64(file, 80 + 24 * level), blocks, at, LengthOf(file, level));
            at += LengthOf(file, level);
        }
        var texture = new Texture2D(BitConverter.ToInt32(file, 20), BitConverter.ToInt32(file, 24), FormatOf(BitConverter.ToInt32(file, 12)),
            levels, true);  // linear: samples as they are stored
        texture.name = Path.GetFileNameWithoutExtension(context.assetPath);
        texture.wrapMode = TextureWrapMode.Clamp;
        texture.filterMode = FilterMode.Trilinear;
        texture.LoadRawTextureData(blocks);
        texture.Apply(false, false);
        var serialized = new SerializedObject(texture);  // no copy in the memory of the CPU
        serialized.FindProperty("m_IsReadable").boolValue = false;
        serialized.ApplyModifiedPropertiesWithoutUndo();
        context.AddObjectToAsset("texture", texture);
        context.SetMainObject(texture);
    }

    private static int LengthOf(byte[] file, int level)
    {
        return (int)BitConverter.ToInt64(file, 80 + 24 * level + 8);
    }

    /// By VkFormat.
    private static TextureFormat FormatOf(int format)
    {
        switch (format)
        {
            case 131: return TextureFormat.DXT1;
            case 139: return TextureFormat.BC4;
            case 141: return TextureFormat.BC5;
            case 145: return TextureFormat.BC7;
            case 157: return TextureFormat.ASTC_4x4;
            case 161: return TextureFormat.ASTC_5x5;
            case 165: return TextureFormat.ASTC_6x6;
            case 171: return TextureFormat.ASTC_8x8;
            case 179: return TextureFormat.ASTC_10x10;
            case 183: return TextureFormat.ASTC_12x12;
        }
        throw new InvalidDataException("FaceZip: blocks of format " + format + " are not known");
    }
}

public sealed class FaceZipImport : AssetPostprocessor
{
    private void OnPreprocessTexture()
    {
        string folder = Path.GetDirectoryName(assetPath);
        if (Path.GetFileName(folder) != "textures" || !File.Exists(Path.Combine(Path.GetDirectoryName(folder), "FaceZip.hlsl"))) return;
        var importer = (TextureImporter)assetImporter;
        bool weights = Path.GetFileName(assetPath).StartsWith("weights_");
        importer.textureType = TextureImporterType.Default;
        importer.sRGBTexture = false;  // samples as they are stored: the shader converts what it has blended
        importer.ignorePngGamma = true;
        importer.alphaSource = TextureImporterAlphaSource.FromInput;
        importer.alphaIsTransparency = false;
        importer.npotScale = TextureImporterNPOTScale.None;
        importer.mipmapEnabled = !weights;
        importer.filterMode = weights ? FilterMode.Point : FilterMode.Trilinear;
        importer.wrapMode = TextureWrapMode.Clamp;
        importer.maxTextureSize = 16384;
        importer.textureCompression = TextureImporterCompression.Uncompressed;
    }

    [MenuItem("Assets/FaceZip/Make Material")]
    private static void MakeMaterial()
    {
        string folder = AssetDatabase.GetAssetPath(Selection.activeObject);
        if (!AssetDatabase.IsValidFolder(folder)) folder = Path.GetDirectoryName(folder).Replace('\\', '/');
        var shader = AssetDatabase.LoadAssetAtPath<Shader>(folder + "/FaceZip.shader");
        if (shader == null)
        {
            Debug.LogError("FaceZip: select the folder that holds FaceZip.shader");
            return;
        }
        var material = new Material(shader);
        for (int i = 0; i < shader.GetPropertyCount(); ++i)
        {
            string name = shader.GetPropertyName(i);
            var texture = AssetDatabase.LoadAssetAtPath<Texture2D>(folder + "/textures/" + name + ".png");
            if (texture == null) texture = AssetDatabase.LoadAssetAtPath<Texture2D>(folder + "/textures/" + name + ".fzktx2");
            if (texture == null) Debug.LogError("FaceZip: " + folder + "/textures/" + name + " is missing");
            material.SetTexture(name, texture);
        }
        AssetDatabase.CreateAsset(material, folder + "/FaceZip.mat");
        Selection.activeObject = material;
    }
}
#endif
