# Every dependency is a Debian package, but what the page of `facezip view` bundles: npm fetches that at build time.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(CGAL 5.5 REQUIRED)
find_package(tinyobjloader REQUIRED)
find_package(OpenCL REQUIRED)
find_package(Imath REQUIRED)  # OpenImageIO's headers need its targets
find_package(OpenImageIO 2.4 REQUIRED)
# Debian's target names OpenCV's headers, which OpenImageIO's own headers need only when asked to; without libopencv-dev
# the folder does not exist and CMake refuses the target.
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER oiio_includes EXCLUDE REGEX "opencv")
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_includes}")
find_package(PkgConfig REQUIRED)
pkg_check_modules(spng REQUIRED IMPORTED_TARGET spng)
find_package(TBB REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(fmt REQUIRED)
find_package(TinyGLTF REQUIRED)
find_package(astcenc 4.2 REQUIRED)
find_package(Boost 1.74 REQUIRED)  # Beast: headers alone
find_program(FACEZIP_NODE node REQUIRED)
find_program(FACEZIP_NPM npm REQUIRED)
if(FACEZIP_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
if(FACEZIP_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
