// Skin whose albedo, normal, roughness and occlusion follow the expressions: FaceZip.hlsl blends them, FaceZipDriver.cs brings the weights.
Shader "FaceZip/@NAME@" {
  Properties {
    @PROPERTIES@
  }

  // Universal Render Pipeline.
  SubShader {
    Tags { "RenderType" = "Opaque" "RenderPipeline" = "UniversalPipeline" "Queue" = "Geometry" }
    Pass {
      Name "ForwardLit"
      Tags { "LightMode" = "UniversalForward" }
      HLSLPROGRAM
      #pragma target 4.5
      #pragma vertex vertex
      #pragma fragment fragment
      #pragma multi_compile _ _MAIN_LIGHT_SHADOWS _MAIN_LIGHT_SHADOWS_CASCADE _MAIN_LIGHT_SHADOWS_SCREEN
      #pragma multi_compile _ _ADDITIONAL_LIGHTS
      #pragma multi_compile_fragment _ _SHADOWS_SOFT
      #pragma multi_compile_fog
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
      #include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"
      #include "FaceZip.hlsl"

      struct Attributes {
        float4 position : POSITION;
        float3 normal : NORMAL;
        float4 tangent : TANGENT;
        float2 uv : TEXCOORD0;
      };
      struct Varyings {
        float4 position : SV_POSITION;
        float2 uv : TEXCOORD0;
        float3 world : TEXCOORD1;
        float3 normal : TEXCOORD2;
        float4 tangent : TEXCOORD3;
        float fog : TEXCOORD4;
      };

      Varyings vertex(Attributes input) {
        Varyings output;
        VertexPositionInputs place = GetVertexPositionInputs(input.position.xyz);
        VertexNormalInputs frame = GetVertexNormalInputs(input.normal, input.tangent);
        output.position = place.positionCS;
        output.world = place.positionWS;
        output.normal = frame.normalWS;
        output.tangent = float4(frame.tangentWS, input.tangent.w * GetOddNegativeScale());
        output.uv = input.uv;
        output.fog = ComputeFogFactor(place.positionCS.z);
        return output;
      }

      half4 fragment(Varyings input) : SV_Target {
        FaceZipSurface face = facezip_surface(input.uv);
        float3 bitangent = input.tangent.w * cross(input.normal, input.tangent.xyz);
        SurfaceData surface = (SurfaceData)0;
        surface.albedo = face.albedo;
        surface.smoothness = 1.0 - face.roughness;
        surface.normalTS = face.normal;
        surface.occlusion = face.occlusion;
        surface.alpha = 1.0;
        InputData light = (InputData)0;
        light.positionWS = input.world;
        light.normalWS = normalize(mul(face.normal, float3x3(input.tangent.xyz, bitangent, input.normal)));
        light.viewDirectionWS = GetWorldSpaceNormalizeViewDir(input.world);
        light.shadowCoord = TransformWorldToShadowCoord(input.world);
        light.fogCoord = input.fog;
        light.bakedGI = SampleSH(light.normalWS);
        light.normalizedScreenSpaceUV = GetNormalizedScreenSpaceUV(input.position);
        light.shadowMask = half4(1.0, 1.0, 1.0, 1.0);
        half4 colour = UniversalFragmentPBR(light, surface);
        return half4(MixFog(colour.rgb, input.fog), 1.0);
      }
      ENDHLSL
    }
    UsePass "Universal Render Pipeline/Lit/ShadowCaster"
    UsePass "Universal Render Pipeline/Lit/DepthOnly"
  }

  // Built-in pipeline.
  SubShader {
    Tags { "RenderType" = "Opaque" }
    CGPROGRAM
    #pragma target 4.5
    #pragma surface surface Standard fullforwardshadows vertex:pass_uv
    #ifndef SHADER_TARGET_SURFACE_ANALYSIS  // whose parser takes no texture objects
    #include "FaceZip.hlsl"
    #endif
    struct Input { float2 mesh_uv; };
    void pass_uv(inout appdata_full vertex, out Input output) {
      UNITY_INITIALIZE_OUTPUT(Input, output);
      output.mesh_uv = vertex.texcoord.xy;
    }
    void surface(Input input, inout SurfaceOutputStandard output) {
      #ifdef SHADER_TARGET_SURFACE_ANALYSIS  // what is written, from what
      output.Albedo = float3(input.mesh_uv, 0.0);
      output.Normal = float3(input.mesh_uv, 1.0);
      output.Smoothness = input.mesh_uv.x;
      output.Occlusion = input.mesh_uv.y;
      #else
      FaceZipSurface face = facezip_surface(input.mesh_uv);
      output.Albedo = face.albedo;
      output.Normal = face.normal;
      output.Smoothness = 1.0 - face.roughness;
      output.Occlusion = face.occlusion;
      #endif
    }
    ENDCG
  }
  FallBack "Diffuse"
}
