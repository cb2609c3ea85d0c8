# Captures whose meshes Blender wrote: cmake -DFACEZIP=... -DBLENDER=... -DCAPTURE=... -DWORK=... -DSCRIPT=... -P capture_blender.cmake
file(REMOVE_RECURSE ${WORK})
foreach(kind glb fbx)
  file(MAKE_DIRECTORY ${WORK}/${kind})
  file(COPY ${CAPTURE}/albedo DESTINATION ${WORK}/${kind})
endforeach()
execute_process(COMMAND ${BLENDER} --background --factory-startup --python-exit-code 1 --python ${SCRIPT} --
                        ${CAPTURE} ${WORK}/glb/head.glb ${WORK}/fbx/head.fbx
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
foreach(kind glb fbx)
  execute_process(COMMAND ${FACEZIP} compress ${WORK}/${kind} --output ${WORK}/${kind}.facezip --method paper --restarts 5
                  OUTPUT_QUIET ERROR_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
  if(said MATCHES "no mesh")
    message(FATAL_ERROR "${kind}: ${said}")
  endif()
  # Every expression moves the mesh.
  file(READ ${WORK}/${kind}.facezip/package.json package)
  string(JSON vertices_file GET "${package}" mesh file)
  file(STRINGS ${WORK}/${kind}.facezip/${vertices_file} text REGEX "targetNames")
  file(GLOB expressions ${CAPTURE}/expressions/*.obj)
  foreach(expression ${expressions})
    cmake_path(GET expression STEM name)
    if(NOT text MATCHES "\"${name}\"")
      message(FATAL_ERROR "${kind}: ${name} is not among the morph targets")
    endif()
  endforeach()
endforeach()
