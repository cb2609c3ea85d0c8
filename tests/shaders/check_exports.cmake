# What the exports for Unity and Unreal bring compiles as HLSL: cmake -DFACEZIP= -DGLSLANG= -DPACKAGE= -DWORK= -P check_exports.cmake
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
foreach(target unity unreal)
  execute_process(COMMAND ${FACEZIP} --quiet export ${PACKAGE} --target ${target} --output ${WORK}/${target}
                  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
function(compile shader)
  execute_process(COMMAND ${GLSLANG} -D -e main -S frag -V --auto-map-bindings --auto-map-locations -o ${shader}.spv ${shader}
                  COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Unity: the surface, as FaceZip.shader calls it, and the node of every map.
file(READ ${WORK}/unreal/FaceZip.json face)
string(JSON nodes LENGTH ${face} nodes)
string(JSON expressions LENGTH ${face} expressions)
math(EXPR last_node "${nodes} - 1")
math(EXPR last_expression "${expressions} - 1")
set(calls "")
foreach(n RANGE ${last_node})
  string(JSON map GET ${face} nodes ${n} map)
  string(APPEND calls "  FaceZip_${map}_float(uv, value);\n  colour += value;\n")
endforeach()
file(WRITE ${WORK}/unity/check.hlsl "#include \"FaceZip.hlsl\"
float4 main(float2 uv : TEXCOORD0) : SV_Target {
  FaceZipSurface surface = facezip_surface(uv);
  float3 albedo, normal;
  float smoothness;
  FaceZip_float(uv, albedo, normal, smoothness);
  float4 colour = float4(surface.albedo + surface.normal + albedo + normal, surface.roughness + smoothness);
  float4 value;
${calls}  return colour;
}\n")
compile(${WORK}/unity/check.hlsl)

# Unreal: each Custom node, as the body of a function with the node's inputs. The struct stands before it: inside a
# function glslang takes the return type of its last method for the function's.
file(READ ${WORK}/unreal/FaceZip.ush blend)
foreach(n RANGE ${last_node})
  string(JSON map GET ${face} nodes ${n} map)
  string(JSON floats GET ${face} nodes ${n} floats)
  string(JSON textures LENGTH ${face} nodes ${n} textures)
  math(EXPR last_texture "${textures} - 1")
  set(globals "")
  set(parameters "float2 uv")
  set(arguments "uv")
  foreach(t RANGE ${last_texture})
    string(JSON texture GET ${face} nodes ${n} textures ${t})
    string(APPEND globals "Texture2D<float4> g_${texture};\nSamplerState g_${texture}Sampler;\n")
    string(APPEND parameters ", Texture2D<float4> ${texture}, SamplerState ${texture}Sampler")
    string(APPEND arguments ", g_${texture}, g_${texture}Sampler")
  endforeach()
  foreach(e RANGE ${last_expression})
    string(APPEND globals "float g_beta_${e};\n")
    string(APPEND parameters ", float beta_${e}")
    string(APPEND arguments ", g_beta_${e}")
  endforeach()
  set(swizzle_1 "xxxx")
  set(swizzle_3 "xyzz")
  set(swizzle_4 "xyzw")
  set(type_1 "float")
  set(type_3 "float3")
  set(type_4 "float4")
  file(READ ${WORK}/unreal/node_${map}.hlsl code)
  file(WRITE ${WORK}/unreal/check_${map}.hlsl "${globals}
${blend}
${type_${floats}} CustomExpression(${parameters}) {
${code}}
float4 main(float2 uv : TEXCOORD0) : SV_Target { return CustomExpression(${arguments}).${swizzle_${floats}}; }\n")
  compile(${WORK}/unreal/check_${map}.hlsl)
endforeach()
