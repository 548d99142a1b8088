# OpenCV by single modules: Debian's OpenCVConfig.cmake comes only with the whole libopencv-dev (673 MB),
# the modules that we use are half of that. Their headers flood C++20 builds with deprecated-enum
# warnings, hence SYSTEM.
find_path(SUREFOOT_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(_module core imgproc imgcodecs calib3d features2d video videoio aruco)
  find_library(SUREFOOT_OPENCV_${_module} opencv_${_module} REQUIRED)
  if(NOT TARGET surefoot_opencv::${_module})
    add_library(surefoot_opencv::${_module} INTERFACE IMPORTED)
    target_include_directories(surefoot_opencv::${_module} SYSTEM INTERFACE ${SUREFOOT_OPENCV_INCLUDE_DIR})
    target_link_libraries(surefoot_opencv::${_module} INTERFACE ${SUREFOOT_OPENCV_${_module}})
  endif()
endforeach()
