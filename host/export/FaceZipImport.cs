// FaceZipImport.cs - imports the textures of faces as they are, and makes their materials: Assets > FaceZip > Make Material.
#if UNITY_EDITOR
using System.IO;
using UnityEditor;
using UnityEngine;

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
            if (texture == null) Debug.LogError("FaceZip: " + folder + "/textures/" + name + ".png is missing");
            material.SetTexture(name, texture);
        }
        AssetDatabase.CreateAsset(material, folder + "/FaceZip.mat");
        Selection.activeObject = material;
    }
}
#endif
