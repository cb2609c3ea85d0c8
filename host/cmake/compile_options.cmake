# Flags shared by every target of ours; linked PRIVATE so that consumers see none of it.
add_library(facezip_compile_options INTERFACE)
target_compile_options(facezip_compile_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                         -Wold-style-cast -Woverloaded-virtual)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 warns of overlapping copies inside std::string's operator+ (GCC bug 105651).
  target_compile_options(facezip_compile_options INTERFACE -Wno-restrict)
endif()
if(FACEZIP_WARNINGS_AS_ERRORS)
  target_compile_options(facezip_compile_options INTERFACE -Werror)
endif()
# A module that misses a symbol fails when it is linked, not when it is loaded; sanitized ones leave theirs to the program.
set(FACEZIP_MODULE_LINK_OPTIONS -Wl,-z,defs)
if(FACEZIP_SANITIZE)
  set(FACEZIP_MODULE_LINK_OPTIONS)
  # The sanitizers' own instructions set off this warning in the standard library (GCC bug 105562).
  target_compile_options(facezip_compile_options INTERFACE -Wno-maybe-uninitialized)
  # Global, not per target: a library built without them would hide the reads of one built with.
  add_compile_options(-fsanitize=${FACEZIP_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${FACEZIP_SANITIZE})
endif()
