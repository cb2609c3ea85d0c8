# A room of the library: the folder host/src/NAME as an object library facezip_NAME.
#   USES     rooms whose headers it sees, with those that they see: an include of any other does not compile
#   LINKS    libraries beside those of all rooms
#   SOURCES  made while building
#   EXCEPT   names of files of the folder that are built elsewhere
# Its folder stands alone, by a link, in an include root of its own: that is what hides the others.
function(facezip_room name)
  cmake_parse_arguments(ROOM "" "" "USES;LINKS;SOURCES;EXCEPT" ${ARGN})
  set(folder ${CMAKE_CURRENT_SOURCE_DIR}/src/${name})
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  foreach(except ${ROOM_EXCEPT})
    list(REMOVE_ITEM sources ${folder}/${except}.cpp)
  endforeach()
  set(include_root ${PROJECT_BINARY_DIR}/rooms/${name})
  file(MAKE_DIRECTORY ${include_root})
  file(CREATE_LINK ${folder} ${include_root}/${name} SYMBOLIC)
  list(TRANSFORM ROOM_USES PREPEND facezip_)

  add_library(facezip_${name} OBJECT ${sources} ${ROOM_SOURCES})
  set_target_properties(facezip_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_include_directories(facezip_${name} PUBLIC ${include_root})
  target_link_libraries(facezip_${name} PUBLIC facezip_beside_rooms ${ROOM_USES} ${ROOM_LINKS} PRIVATE facezip_compile_options)
  set_property(GLOBAL APPEND PROPERTY FACEZIP_ROOM_OBJECTS $<TARGET_OBJECTS:facezip_${name}>)
endfunction()
