// Images and poses between NumPy and the library. All need the GIL.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/io/trajectory.h"
#include "python.h"

namespace alidade::python {

// An array's memory as an image. Not copied, unless pixels do not lie side by side in growing rows
// (flipped, transposed, every other column): then once.
struct WrappedImage {
  cv::Mat image;      // empty: None was given
  py::object memory;  // keeps it, must live as long as the image
};

// (h, w) or (h, w, 3 or 4) of uint8. Throws Error (input) for what is something else; `name` is the
// argument's.
WrappedImage WrapImage(const py::handle& array, const std::string& name);
// (h, w) of uint16 or float32.
WrappedImage WrapDepth(const py::handle& array, const std::string& name);

// The array shares the image's memory where OpenCV counts who holds it, else it is a copy. None for
// an empty image.
py::object ArrayOf(const cv::Mat& image);

py::array_t<double> PoseArray(const Se3& pose);                // (4, 4)
py::array_t<double> PoseArray(const std::vector<Se3>& poses);  // (n, 4, 4)
py::array_t<double> TrajectoryArray(const Trajectory& poses);  // (n, 8): t, translation, x y z w
// Throws Error (input) for what is not (n, 8), or has rows that are no poses. A pose's number is in
// the message.
Trajectory TrajectoryOf(const py::handle& array, const std::string& name);

// Rows of `width` values as (n, width); with width 0 as (n,).
template <typename T>
py::array_t<T> Table(const std::vector<T>& values, int width = 0) {
  if (width == 0) return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
  return py::array_t<T>({static_cast<py::ssize_t>(values.size()) / width, py::ssize_t{width}},
                        values.data());
}

}  // namespace alidade::python
