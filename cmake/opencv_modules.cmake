# Links single OpenCV modules. Debian's OpenCVConfig.cmake needs the whole libopencv-dev (673 MB);
# the used modules are half of that. SYSTEM suppresses the many deprecated-enum warnings of their
# headers in C++20.
find_path(SUREFOOT_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(_module core imgproc imgcodecs calib3d features2d video videoio aruco)
  find_library(SUREFOOT_OPENCV_${_module} opencv_${_module} REQUIRED)
  if(NOT TARGET surefoot_opencv::${_module})
    add_library(surefoot_opencv::${_module} INTERFACE IMPORTED)
    target_include_directories(surefoot_opencv::${_module} SYSTEM INTERFACE ${SUREFOOT_OPENCV_INCLUDE_DIR})
    target_link_libraries(surefoot_opencv::${_module} INTERFACE ${SUREFOOT_OPENCV_${_module}})
  endif()
endforeach()
