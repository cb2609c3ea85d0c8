# OpenCV's optical flow, as OpenCV::video. Debian's own OpenCVConfig.cmake comes with libopencv-dev, which wants all of
# OpenCV and VTK beside it; libopencv-video-dev is enough.
find_path(FACEZIP_OPENCV_INCLUDE opencv2/video/tracking.hpp PATH_SUFFIXES opencv4 REQUIRED)
set(FACEZIP_OPENCV_LIBRARIES)
foreach(module video imgproc core)
  find_library(FACEZIP_OPENCV_${module} opencv_${module} REQUIRED)
  list(APPEND FACEZIP_OPENCV_LIBRARIES ${FACEZIP_OPENCV_${module}})
endforeach()
if(NOT TARGET OpenCV::video)
  add_library(OpenCV::video INTERFACE IMPORTED)
  set_target_properties(OpenCV::video PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${FACEZIP_OPENCV_INCLUDE}"
    # Programs that take no flow do not load it, though the library that they link could.
    INTERFACE_LINK_LIBRARIES "-Wl,--push-state,--as-needed;${FACEZIP_OPENCV_LIBRARIES};-Wl,--pop-state")
endif()
