# `cmake --install` gives headers, libraries, the command and a CMake package: find_package(facezip).
include(CMakePackageConfigHelpers)
set(FACEZIP_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/facezip)

install(TARGETS facezip facezip_geometry facezip_runtime EXPORT facezipTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY geometry/include/ host/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/host/include/facezip/version.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/facezip)
install(EXPORT facezipTargets NAMESPACE facezip:: DESTINATION ${FACEZIP_CMAKE_DIR})

if(NOT DEFINED BUILD_SHARED_LIBS)
  set(BUILD_SHARED_LIBS OFF)
endif()
configure_package_config_file(host/cmake/facezipConfig.cmake.in ${PROJECT_BINARY_DIR}/facezipConfig.cmake
  INSTALL_DESTINATION ${FACEZIP_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/facezipConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/facezipConfig.cmake ${PROJECT_BINARY_DIR}/facezipConfigVersion.cmake
              host/cmake/opencv_video.cmake
  DESTINATION ${FACEZIP_CMAKE_DIR})

# For builds without CMake: the C interface, which needs nothing else at link time.
file(RELATIVE_PATH FACEZIP_PKGCONFIG_TO_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(host/cmake/facezip-runtime.pc.in facezip-runtime.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/facezip-runtime.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
