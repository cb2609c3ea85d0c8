# A step has one name: fails where a kernel of kernels/cl lacks the host file, test, reference, problem or row of a
# benchmark that is called like it.
#   cmake -DSOURCE_DIR=DIR -P step_names.cmake

# Kernels that are part of a step with another name.
set(STEP_OF_gram_gpu gram)                    # the form for GPUs
set(STEP_OF_gram_reduce gram)                 # its second launch
set(STEP_OF_weight_system_gpu weight_system)  # the form for GPUs

# Kernels of block formats share one encoder and one decoder, tests, references and benchmarks, which are named after
# those: host file, test, reference, file of benchmarks.
set(BLOCKS_OF_bc1_encode blocks/bc_encoder block_encode block_search block)
set(BLOCKS_OF_bc4_encode ${BLOCKS_OF_bc1_encode})
set(BLOCKS_OF_bc7_encode ${BLOCKS_OF_bc1_encode})
set(BLOCKS_OF_block_decode blocks/device_block_decoder block_decode block_formats block)

set(missing "")
macro(require what)
  if(NOT found)
    list(APPEND missing "${kernel}: no ${what}")
  endif()
endmacro()

file(GLOB kernels ${SOURCE_DIR}/kernels/cl/*.cl)
foreach(file IN LISTS kernels)
  get_filename_component(kernel ${file} NAME_WE)
  set(step ${kernel})
  if(DEFINED STEP_OF_${kernel})
    set(step ${STEP_OF_${kernel}})
  endif()

  file(STRINGS ${file} found REGEX "(^| )${kernel}\\(")
  require("kernel of that name in ${kernel}.cl")
  if(DEFINED BLOCKS_OF_${kernel})
    list(GET BLOCKS_OF_${kernel} 0 host)
    list(GET BLOCKS_OF_${kernel} 1 test)
    list(GET BLOCKS_OF_${kernel} 2 reference)
    list(GET BLOCKS_OF_${kernel} 3 bench)
    foreach(path host/src/${host}.cpp tests/kernels/${test}_test.cpp tests/reference/${reference}.hpp bench/${bench}_bench.cpp)
      file(GLOB found ${SOURCE_DIR}/${path})
      require(${path})
    endforeach()
    continue()
  endif()
  file(GLOB_RECURSE found ${SOURCE_DIR}/host/src/*/${step}.cpp)
  require("host/src/*/${step}.cpp")
  file(GLOB found ${SOURCE_DIR}/tests/kernels/${step}_test.cpp)
  require("tests/kernels/${step}_test.cpp")
  file(GLOB found ${SOURCE_DIR}/tests/reference/${step}.hpp)
  require("tests/reference/${step}.hpp")
  file(GLOB found ${SOURCE_DIR}/tests/problems/${step}.hpp)
  require("tests/problems/${step}.hpp")
  set(found "")
  set(bench ${SOURCE_DIR}/bench/${step}_bench.cpp)
  if(EXISTS ${bench})
    file(STRINGS ${bench} found REGEX "Name\\(\"${step}[\"/]|BENCHMARK\\(${step}\\)")
  endif()
  require("row ${step} in bench/${step}_bench.cpp")
endforeach()

list(LENGTH kernels count)
if(count EQUAL 0)
  message(FATAL_ERROR "no kernels in ${SOURCE_DIR}/kernels/cl")
endif()
if(missing)
  list(JOIN missing "\n  " missing)
  message(FATAL_ERROR "CONTRIBUTING.md says how steps are named:\n  ${missing}")
endif()
message(STATUS "${count} kernels, each with its host file, test, reference, problem and benchmark")
