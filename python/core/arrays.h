// Conversion of images and poses between NumPy and the library. All functions require the GIL.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/geometry/se3.h"
#include "alidade/inertial/imu.h"
#include "alidade/io/trajectory.h"
#include "python.h"

namespace alidade::python {

// An array's memory as an image. Copied only if pixels are not contiguous within rows (flipped,
// transposed, strided), not aligned, or of another byte order.
struct WrappedImage {
  cv::Mat image;      // empty for None
  py::object memory;  // owner of the memory; must live as long as the image
};

// NumPy arrays, and what NumPy can see as one: __array__, the buffer protocol, __dlpack__ in the
// memory of the CPU (tensors of PyTorch and others).
// (h, w) or (h, w, 3 or 4) of uint8. Throws ArrayError for anything else; `name` is the argument's
// name.
WrappedImage WrapImage(const py::handle& array, const std::string& name);
// (h, w) of uint16 or float32, in any byte order; other floating-point numbers are converted to
// float32.
WrappedImage WrapDepth(const py::handle& array, const std::string& name);

// In messages, instead of its content: "an array (240, 320) of uint8", "a list".
std::string Described(const py::handle& value);

// The array shares the image's memory if OpenCV counts its references, else it is a copy. None for
// an empty image.
py::object ArrayOf(const cv::Mat& image);

py::array_t<double> PoseArray(const Se3& pose);                // (4, 4)
py::array_t<double> PoseArray(const std::vector<Se3>& poses);  // (n, 4, 4)
// (6, 6); none if it is zero: unknown.
py::object CovarianceArray(const Matrix6d& covariance);
py::array_t<double> TrajectoryArray(const Trajectory& poses);  // (n, 8): t, translation, x y z w
py::array_t<double> ImuArray(const std::vector<ImuSample>& readings);  // (n, 7)
// The same back; none for None. Throws ArrayError when the array is not (n, 7) numbers.
std::vector<ImuSample> ImuSamplesOf(const py::handle& array, const std::string& name);
// A pose, (4, 4). Throws ArrayError.
Se3 PoseFrom(const py::handle& array, const std::string& name);
// Throws ArrayError when the array is not (n, 8), Error (input), with the row's number, when a row
// is not a pose.
Trajectory TrajectoryOf(const py::handle& array, const std::string& name);

// Rows of `width` values as an (n, width) array; width 0: an (n,) array.
template <typename T>
py::array_t<T> Table(const std::vector<T>& values, int width = 0) {
  if (width == 0) return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
  return py::array_t<T>({static_cast<py::ssize_t>(values.size()) / width, py::ssize_t{width}},
                        values.data());
}

}  // namespace alidade::python
