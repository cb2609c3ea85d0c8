# Installs facezip, builds the consumer against the installed package alone and runs it.
#   BUILD_DIR facezip's build, WORK_DIR scratch, SOURCE_DIR this folder, FACEZIP the command
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: exit code ${result}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${WORK_DIR}/build -G Ninja -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix "-DCMAKE_EXE_LINKER_FLAGS=${LINK_FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/prefix/bin/facezip synth --output ${WORK_DIR}/capture --resolution 128 --expressions 3 --maps albedo)
run(${WORK_DIR}/build/consumer ${WORK_DIR}/capture ${WORK_DIR}/package)
# The installed command finds its modules: OpenImageIO for TIFF, pictures.
run(${WORK_DIR}/prefix/bin/facezip blend ${WORK_DIR}/package --weights jaw_open_wide=1 --output ${WORK_DIR}/frame.tif)
run(${WORK_DIR}/prefix/bin/facezip evaluate ${WORK_DIR}/capture ${WORK_DIR}/package --baselines none --blends 0
    --picture ${WORK_DIR}/errors.png)
run(${WORK_DIR}/build/runtime ${WORK_DIR}/package)
if(NOT EXISTS ${WORK_DIR}/package/package.json)
  message(FATAL_ERROR "the consumer wrote no package")
endif()
