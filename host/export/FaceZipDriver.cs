// FaceZipDriver.cs - lets the textures of a face follow its blend shapes. Put it on the SkinnedMeshRenderer.
using System;
using System.Collections.Generic;
using UnityEngine;

[ExecuteAlways]
[RequireComponent(typeof(SkinnedMeshRenderer))]
public sealed class FaceZipDriver : MonoBehaviour
{
    [Tooltip("FaceZip.json of the face: names of the expressions in the order of its weight maps")]
    public TextAsset face;

    [Serializable]
    private sealed class Face
    {
        public string[] expressions = new string[0];
    }

    private static readonly int Weights = Shader.PropertyToID("fz_beta");
    private readonly Dictionary<string, float> extra = new Dictionary<string, float>();
    private SkinnedMeshRenderer head;
    private MaterialPropertyBlock block;
    private Mesh mesh;
    private string[] expressions = new string[0];
    private int[] blendShapes = new int[0];  // -1: none of that name
    private float[] weights = new float[0];
    private readonly List<SkinnedMeshRenderer> parts = new List<SkinnedMeshRenderer>();  // eyes, teeth: importers may set them apart

    private void OnEnable()
    {
        head = GetComponent<SkinnedMeshRenderer>();
        block = new MaterialPropertyBlock();
        mesh = null;
    }

    private void OnValidate()
    {
        mesh = null;
    }

    /// Weight of an expression that has no blend shape; others follow theirs.
    public void SetWeight(string expression, float weight)
    {
        extra[expression] = weight;
    }

    private void LateUpdate()
    {
        if (face == null || head.sharedMesh == null) return;
        if (mesh != head.sharedMesh) Bind();
        for (int n = 0; n < expressions.Length; ++n)
        {
            int shape = blendShapes[n];
            float weight;
            if (shape < 0) extra.TryGetValue(expressions[n], out weight);
            // Importers differ in what they call full: 1 or 100.
            else weight = head.GetBlendShapeWeight(shape) / mesh.GetBlendShapeFrameWeight(shape, mesh.GetBlendShapeFrameCount(shape) - 1);
            weights[n] = weight;
        }
        foreach (SkinnedMeshRenderer part in parts)
        {
            for (int n = 0; n < part.sharedMesh.blendShapeCount; ++n)
            {
                int shape = mesh.GetBlendShapeIndex(part.sharedMesh.GetBlendShapeName(n));
                if (shape >= 0) part.SetBlendShapeWeight(n, head.GetBlendShapeWeight(shape));
            }
        }
        head.GetPropertyBlock(block);
        block.SetFloatArray(Weights, weights);
        head.SetPropertyBlock(block);
    }

    private void Bind()
    {
        mesh = head.sharedMesh;
        expressions = JsonUtility.FromJson<Face>(face.text).expressions;
        weights = new float[expressions.Length];
        blendShapes = new int[expressions.Length];
        for (int n = 0; n < expressions.Length; ++n) blendShapes[n] = mesh.GetBlendShapeIndex(expressions[n]);
        parts.Clear();
        Transform above = transform.parent != null ? transform.parent : transform;
        foreach (SkinnedMeshRenderer part in above.GetComponentsInChildren<SkinnedMeshRenderer>())
        {
            if (part != head && part.sharedMesh != null && part.GetComponent<FaceZipDriver>() == null) parts.Add(part);
        }
        block = new MaterialPropertyBlock();  // an array keeps the length that it had first
    }
}
