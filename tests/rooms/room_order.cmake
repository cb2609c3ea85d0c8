# Fails where a room of host/src is not in the list, where a room sees one that lies behind it, or where the compiler lets
# an include upward pass.
#   cmake -DSOURCE_DIR=DIR -DCOMPILER=CXX -DINCLUDE_DIRECTORIES=FILE "-DROOMS=io;device;..." -P room_order.cmake
# FILE has a line for each room: name=dir|dir|...

cmake_minimum_required(VERSION 3.25)
file(GLOB folders RELATIVE ${SOURCE_DIR}/host/src ${SOURCE_DIR}/host/src/*)
list(REMOVE_ITEM folders runtime)  # a library of its own: the C interface
foreach(folder ${folders})
  if(NOT folder IN_LIST ROOMS)
    message(FATAL_ERROR "host/src/${folder} is not in the list of rooms (tests/rooms/CMakeLists.txt, host/CMakeLists.txt)")
  endif()
endforeach()

file(STRINGS ${INCLUDE_DIRECTORIES} lines)
foreach(line ${lines})
  string(REGEX MATCH "^([a-z]+)=(.*)$" line "${line}")
  string(REPLACE "|" ";" seen_of_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
endforeach()

set(behind ${ROOMS})
foreach(room ${ROOMS})
  list(REMOVE_ITEM behind ${room})
  foreach(directory ${seen_of_${room}})
    foreach(other ${behind})
      if(EXISTS ${directory}/${other})
        message(FATAL_ERROR "${room} sees ${other}, which lies behind it, in ${directory}")
      endif()
    endforeach()
  endforeach()
endforeach()

# Whether a file of `room` that includes `header` gets through the preprocessor.
function(includes room header result)
  list(TRANSFORM seen_of_${room} PREPEND -I OUTPUT_VARIABLE flags)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/room_order.cpp)
  file(WRITE ${file} "#include \"${header}\"\n")
  execute_process(COMMAND ${COMPILER} -std=c++20 -E ${flags} ${file} OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE failed)
  file(REMOVE ${file})
  if(failed EQUAL 0)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

includes(image io/counts.hpp down)
includes(image compress/attempt.hpp up)
if(NOT down OR up)
  message(FATAL_ERROR "image: include of io compiles: ${down}; of compress, which lies behind it: ${up}")
endif()
list(LENGTH ROOMS count)
message(STATUS "${count} rooms, each sees those before it")
