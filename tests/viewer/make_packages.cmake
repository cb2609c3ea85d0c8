# Packages for the tests of the viewer and of exports: cmake -DFACEZIP=... -DOUTPUT=... -P make_packages.cmake
function(facezip)
  execute_process(COMMAND ${FACEZIP} --quiet ${ARGN} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endfunction()
file(REMOVE_RECURSE ${OUTPUT})
file(MAKE_DIRECTORY ${OUTPUT})
facezip(synth --output ${OUTPUT}/capture --resolution 128 --expressions 6 --template)
facezip(compress ${OUTPUT}/capture --output ${OUTPUT}/head --restarts 10)
facezip(compress ${OUTPUT}/capture --output ${OUTPUT}/bare --restarts 10 --maps albedo --no-mesh)
foreach(format bc7 astc-5x5)
  facezip(compress ${OUTPUT}/capture --output ${OUTPUT}/${format} --restarts 10 --texture-format ${format})
endforeach()
facezip(rig ${OUTPUT}/capture --template ${OUTPUT}/capture/template --output ${OUTPUT}/rig --iterations 1 --restarts 5)
file(COPY ${OUTPUT}/capture/template DESTINATION ${OUTPUT}/with_parts)
set(FOLDER ${OUTPUT}/with_parts/template)
include(${CMAKE_CURRENT_LIST_DIR}/append_parts.cmake)
facezip(rig ${OUTPUT}/capture --template ${FOLDER} --output ${OUTPUT}/parts --iterations 1 --restarts 5 --eyes blue)
facezip(export ${OUTPUT}/parts --target gltf --output ${OUTPUT}/parts_gltf)
facezip(export ${OUTPUT}/head --target gltf --output ${OUTPUT}/gltf)
facezip(export ${OUTPUT}/bc7 --target gltf --output ${OUTPUT}/gltf_blocks)
# As a registration leaves it in its capture, and tells of it; a scan's name is a stranger's text.
file(MAKE_DIRECTORY ${OUTPUT}/capture/registration)
file(COPY_FILE ${OUTPUT}/capture/albedo/neutral.png ${OUTPUT}/capture/registration/neutral.png)
file(WRITE ${OUTPUT}/register.json [[{"facezip_report": "register", "flow_side": 512, "scans": [
  {"name": "neutral", "residual_mm": {"mean": 0.0461, "p99": 0.2}, "coverage": 1},
  {"name": "<b>bold</b>", "residual_mm": {"mean": 0.05, "p99": 0.3}, "coverage": 0.9, "head_motion": {"degrees": 2.5},
   "flow_texels": {"rounds": 2, "before": {"mean": 1.46, "p95": 4}, "after": {"mean": 0.1, "p95": 0.4}}}]}]])
facezip(report ${OUTPUT}/capture ${OUTPUT}/head --output ${OUTPUT}/report.html --mask-sweep 8,20
        --registration-report ${OUTPUT}/register.json)
facezip(synth --output ${OUTPUT}/many_capture --resolution 64 --expressions 100 --maps albedo)
facezip(compress ${OUTPUT}/many_capture --output ${OUTPUT}/many --restarts 5 --differences 5)
