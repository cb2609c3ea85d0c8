# Installs facezip, builds the consumer against the installed package alone and runs it.
#   BUILD_DIR facezip's build, WORK_DIR scratch, SOURCE_DIR this folder, LINK_FLAGS, C_COMPILER
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
# Without CMake: what pkg-config says is enough to build the same program.
file(GLOB_RECURSE pc ${WORK_DIR}/prefix/*/facezip-runtime.pc)
get_filename_component(folder ${pc} DIRECTORY)
find_program(PKG_CONFIG pkg-config REQUIRED)
execute_process(COMMAND ${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${folder} ${PKG_CONFIG} --cflags --libs facezip-runtime
                OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags)
get_filename_component(libraries ${folder} DIRECTORY)
run(${C_COMPILER} ${SOURCE_DIR}/runtime.c -o ${WORK_DIR}/plain ${flags} -Wl,-rpath,${libraries} ${LINK_FLAGS})
run(${WORK_DIR}/plain ${WORK_DIR}/package)
if(NOT EXISTS ${WORK_DIR}/package/package.json)
  message(FATAL_ERROR "the consumer wrote no package")
endif()
