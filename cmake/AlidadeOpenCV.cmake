# Finds OpenCV: by its own configuration (Debian: libopencv-dev), else as scripts/setup --demo installs it: the libraries
# of libopencv-video-dev, and headers unpacked beside the build. Sets OpenCV_INCLUDE_DIRS; targets opencv_core, …
find_package(OpenCV 4.5 QUIET COMPONENTS core imgproc video calib3d)
if(OpenCV_FOUND)
  return()
endif()
find_path(OPENCV_INCLUDE_DIR opencv2/video/tracking.hpp PATH_SUFFIXES opencv4)
find_path(OPENCV_HEADERS opencv2/calib3d.hpp PATHS ${PROJECT_SOURCE_DIR}/build/opencv-headers/usr/include PATH_SUFFIXES opencv4)
if(NOT OPENCV_INCLUDE_DIR OR NOT OPENCV_HEADERS)
  message(FATAL_ERROR "OpenCV 4.5 was not found (Debian: libopencv-dev)")
endif()
set(OpenCV_INCLUDE_DIRS ${OPENCV_INCLUDE_DIR} ${OPENCV_HEADERS})
foreach(MODULE core imgproc video calib3d)
  file(GLOB LIBRARY /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/libopencv_${MODULE}.so /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/libopencv_${MODULE}.so.*)
  list(POP_FRONT LIBRARY LIBRARY)
  add_library(opencv_${MODULE} UNKNOWN IMPORTED)
  set_target_properties(opencv_${MODULE} PROPERTIES IMPORTED_LOCATION ${LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIRS}"
                        INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIRS}")
endforeach()
