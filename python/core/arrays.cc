#include "arrays.h"

#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "errors.h"

namespace alidade::python {
namespace {

std::string ShapeOf(const py::array& array) {
  return py::str(py::tuple(array.attr("shape"))).cast<std::string>() + " of " +
         py::str(array.dtype()).cast<std::string>();
}

[[noreturn]] void Refuse(const std::string& message) { throw ArrayError(message); }

py::module_ Numpy() { return py::module_::import("numpy"); }

// Pixels are contiguous within rows, and rows are in ascending order.
bool HasRows(const py::array& array, py::ssize_t pixel_bytes) {
  const bool pixels = array.shape(1) < 2 || array.strides(1) == pixel_bytes;
  const bool channels = array.ndim() < 3 || array.shape(2) < 2 || array.strides(2) == 1;
  const bool rows = array.shape(0) < 2 || array.strides(0) >= array.shape(1) * pixel_bytes;
  const bool aligned = (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
  return pixels && channels && rows && aligned;
}

WrappedImage Wrap(const py::array& given, int type, py::ssize_t pixel_bytes) {
  py::array array = given;
  if (!HasRows(array, pixel_bytes)) array = Numpy().attr("require")(array, py::none(), "CA");
  const auto rows = static_cast<int>(array.shape(0)), columns = static_cast<int>(array.shape(1));
  const auto least = static_cast<size_t>(columns * pixel_bytes);
  const size_t step = rows > 1 ? static_cast<size_t>(array.strides(0)) : least;
  return {cv::Mat(rows, columns, type, const_cast<void*>(array.data()), step), array};
}

// NumPy's view of the value.
py::array Seen(const py::handle& value, const std::string& name) {
  if (py::isinstance<py::array>(value)) return py::reinterpret_borrow<py::array>(value);
  const bool sequence = PyList_Check(value.ptr()) != 0 || PyTuple_Check(value.ptr()) != 0;
  const bool shown = sequence || py::hasattr(value, "__array__") ||
                     py::hasattr(value, "__array_interface__") ||
                     PyObject_CheckBuffer(value.ptr()) != 0;
  try {
    if (shown) return Numpy().attr("asarray")(value);
    if (py::hasattr(value, "__dlpack__")) return Numpy().attr("from_dlpack")(value);
  } catch (py::error_already_set& error) {  // on another device, or needs its gradient
    if (!error.matches(PyExc_Exception)) throw;
    Refuse(name + " cannot be read as an array: " + py::str(error.value()).cast<std::string>());
  }
  Refuse(name + " must be an array, not " + Described(value));
}

py::array ArrayFrom(const py::handle& value, const std::string& name) {
  py::array array = Seen(value, name);
  if (array.size() == 0) Refuse(name + " is empty: " + ShapeOf(array));
  // Numbers of one byte have no order.
  if (array.dtype().attr("isnative").cast<bool>()) return array;
  return array.attr("astype")(array.dtype().attr("newbyteorder")("="));
}

// (3, h, w), as networks have it.
std::string ChannelsFirst(const py::array& array, const std::string& name) {
  if (array.ndim() != 3 || array.shape(0) > 4 || array.shape(2) <= 4) return "";
  return "; numpy.moveaxis(" + name + ", 0, -1) puts the channels last";
}

void FillPose(const Se3& pose, double* out) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out[4 * row + column] = pose.R(row, column);
    out[4 * row + 3] = pose.t[row];
    out[12 + row] = 0;
  }
  out[15] = 1;
}

bool HoldsNumbers(const py::array& array) {
  const char kind = array.dtype().kind();
  return kind == 'f' || kind == 'i' || kind == 'u';
}

}  // namespace

WrappedImage WrapImage(const py::handle& value, const std::string& name) {
  if (value.is_none()) return {};
  const py::array array = ArrayFrom(value, name);
  const bool grey = array.ndim() == 2 || (array.ndim() == 3 && array.shape(2) == 1);
  const bool color = array.ndim() == 3 && (array.shape(2) == 3 || array.shape(2) == 4);
  if (!py::isinstance<py::array_t<uint8_t>>(array) || !(grey || color)) {
    Refuse(name + " must be (height, width) or (height, width, 3) of uint8, not " + ShapeOf(array) +
           ChannelsFirst(array, name));
  }
  const int channels = grey ? 1 : static_cast<int>(array.shape(2));
  return Wrap(array, CV_8UC(channels), channels);
}

WrappedImage WrapDepth(const py::handle& value, const std::string& name) {
  if (value.is_none()) return {};
  py::array array = ArrayFrom(value, name);
  if (array.dtype().kind() == 'f' && !py::isinstance<py::array_t<float>>(array))
    array = array.attr("astype")("float32");
  const bool whole = py::isinstance<py::array_t<uint16_t>>(array);
  if (array.ndim() != 2 || !(whole || py::isinstance<py::array_t<float>>(array))) {
    Refuse(name +
           " must be (height, width) of float32 (meters) or uint16 (depth_factor per meter), not " +
           ShapeOf(array));
  }
  return Wrap(array, whole ? CV_16U : CV_32F, whole ? 2 : 4);
}

std::string Described(const py::handle& value) {
  if (py::isinstance<py::array>(value))
    return "an array " + ShapeOf(py::reinterpret_borrow<py::array>(value));
  return "a " + py::str(py::type::of(value).attr("__name__")).cast<std::string>();
}

py::object ArrayOf(const cv::Mat& image) {
  if (image.empty()) return py::none();
  // An OpenCV image without reference count does not own its memory: copy it.
  auto* held = new cv::Mat(image.u != nullptr ? image : image.clone());
  const py::capsule keeper(held, [](void* mat) { delete static_cast<cv::Mat*>(mat); });
  std::vector<py::ssize_t> shape = {held->rows, held->cols};
  std::vector<py::ssize_t> strides = {static_cast<py::ssize_t>(held->step[0]),
                                      static_cast<py::ssize_t>(held->elemSize())};
  if (held->channels() > 1) {
    shape.push_back(held->channels());
    strides.push_back(static_cast<py::ssize_t>(held->elemSize1()));
  }
  const py::dtype type = held->depth() == CV_8U    ? py::dtype::of<uint8_t>()
                         : held->depth() == CV_16U ? py::dtype::of<uint16_t>()
                                                   : py::dtype::of<float>();
  return py::array(type, shape, strides, held->data, keeper);
}

py::array_t<double> PoseArray(const Se3& pose) {
  py::array_t<double> array({4, 4});
  FillPose(pose, array.mutable_data());
  return array;
}

py::array_t<double> PoseArray(const std::vector<Se3>& poses) {
  py::array_t<double> array(
      {static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  for (size_t i = 0; i < poses.size(); ++i) FillPose(poses[i], array.mutable_data() + 16 * i);
  return array;
}

py::object CovarianceArray(const Matrix6d& covariance) {
  if (covariance.isZero(0)) return py::none();
  py::array_t<double> array({6, 6});
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      *array.mutable_data(row, column) = covariance(row, column);
  }
  return array;
}

py::array_t<double> TrajectoryArray(const Trajectory& poses) {
  py::array_t<double> array({static_cast<py::ssize_t>(poses.size()), py::ssize_t{8}});
  double* out = array.mutable_data();
  for (const StampedPose& pose : poses) {
    const Eigen::Quaterniond q = pose.T_world_camera.Quaternion();
    const Eigen::Vector3d& t = pose.T_world_camera.t;
    for (double value : {pose.time, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()})
      *out++ = value;
  }
  return array;
}

py::array_t<double> ImuArray(const std::vector<ImuSample>& readings) {
  py::array_t<double> array({static_cast<py::ssize_t>(readings.size()), py::ssize_t{7}});
  double* out = array.mutable_data();
  for (const ImuSample& reading : readings) {
    *out++ = reading.time;
    for (int axis = 0; axis < 3; ++axis) *out++ = reading.angular_rate[axis];
    for (int axis = 0; axis < 3; ++axis) *out++ = reading.specific_force[axis];
  }
  return array;
}

std::vector<ImuSample> ImuSamplesOf(const py::handle& value, const std::string& name) {
  if (value.is_none()) return {};
  const py::array given = Seen(value, name);
  if (!HoldsNumbers(given) || given.ndim() != 2 || given.shape(1) != 7)
    Refuse(name + " must be (n, 7) numbers: time, angular rate x y z, specific force x y z, not " +
           ShapeOf(given));
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  std::vector<ImuSample> readings;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const double* row = array.data(i, 0);
    readings.push_back({row[0], {row[1], row[2], row[3]}, {row[4], row[5], row[6]}});
  }
  return readings;
}

Se3 PoseFrom(const py::handle& value, const std::string& name) {
  const py::array given = Seen(value, name);
  if (!HoldsNumbers(given) || given.ndim() != 2 || given.shape(0) != 4 || given.shape(1) != 4)
    Refuse(name + " must be a pose, (4, 4) numbers, not " + ShapeOf(given));
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  Se3 pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.R(row, column) = *array.data(row, column);
    pose.t[row] = *array.data(row, 3);
  }
  return pose;
}

Trajectory TrajectoryOf(const py::handle& value, const std::string& name) {
  const py::array given = Seen(value, name);
  if (!HoldsNumbers(given) || given.ndim() != 2 || given.shape(1) != 8)
    Refuse(name + " must be (n, 8) numbers: timestamp tx ty tz qx qy qz qw, not " + ShapeOf(given));
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const double* row = array.data(i, 0);
    const Eigen::Quaterniond q(row[7], row[4], row[5], row[6]);
    if (!(std::abs(q.norm() - 1) < 0.05))  // the same tolerance as for files
      ThrowInput(name + ": row " + std::to_string(i) + " is not a unit quaternion");
    trajectory.push_back({row[0], Se3::FromQuaternion(q, {row[1], row[2], row[3]}), {}});
  }
  return trajectory;
}

}  // namespace alidade::python
