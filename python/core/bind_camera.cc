#include <optional>
#include <string>

#include "alidade/base/error.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/file.h"
#include "alidade/run/setup/options.h"
#include "arrays.h"
#include "values.h"

namespace alidade::python {
namespace {

// `path` as Python's functions need it: without images, the file must state their size.
Calibration SizedCalibration(const std::string& path, Sensor sensor) {
  Calibration calibration = ReadCameraFile(path);
  RequireSize(calibration, sensor == Sensor::kStereo);
  return calibration;
}

// Converts raw images to those of a pinhole camera or a rectified pair, by a camera file.
class Rectifier {
 public:
  Rectifier(const std::string& path, const std::string& sensor)
      : calibration_(SizedCalibration(path, SensorNamed("sensor", sensor))),
        preparation_(calibration_, SensorNamed("sensor", sensor)) {}

  py::object camera() const { return CameraObject(preparation_.camera()); }
  py::object Left(const py::handle& image) const {
    return Apply(WrapImage(image, "image"), &ImagePreparation::Left);
  }
  py::object Right(const py::handle& image) const {
    return Apply(WrapImage(image, "right"), &ImagePreparation::Right);
  }
  py::object Depth(const py::handle& depth) const {
    return Apply(WrapDepth(depth, "depth"), &ImagePreparation::Depth);
  }

 private:
  py::object Apply(const WrappedImage& given,
                   cv::Mat (ImagePreparation::*apply)(const cv::Mat&) const) const {
    cv::Mat made;
    {
      const py::gil_scoped_release release;
      made = (preparation_.*apply)(given.image);
    }
    return made.data == given.image.data ? given.memory : ArrayOf(made);
  }

  Calibration calibration_;
  ImagePreparation preparation_;
};

py::object ReadCamera(const std::string& path, const std::string& sensor) {
  const Sensor wanted = SensorNamed("sensor", sensor);
  const Calibration calibration = SizedCalibration(path, wanted);
  if (calibration.left.lens == Lens::kFisheye || (wanted == Sensor::kStereo && calibration.right)) {
    ThrowUsage(path + ": images of this camera must be rectified with alidade.Rectifier");
  }
  return CameraObject(ImagePreparation(calibration, wanted).camera());
}

}  // namespace

void BindCamera(py::module_& core) {
  core.def("check_imu", [](const py::object& imu) { ImuFrom(imu); });
  core.def("check_camera", [](const py::object& camera) { CameraFrom(camera); });
  core.def("read_camera", &ReadCamera, py::arg("path"), py::arg("sensor"));
  core.def("write_camera", [](const std::string& path, const py::object& camera) {
    AtomicWriteFile(path, FormatCameraFile(CameraFrom(camera)));
  });
  core.def("camera_from_fov", [](int width, int height, double degrees) {
    return CameraObject(Camera::FromFieldOfView(width, height, degrees));
  });
  py::class_<Rectifier>(core, "Rectifier")
      .def(py::init<const std::string&, const std::string&>(), py::arg("path"), py::arg("sensor"))
      .def_property_readonly("camera", &Rectifier::camera)
      .def("left", &Rectifier::Left)
      .def("right", &Rectifier::Right)
      .def("depth", &Rectifier::Depth);
}

}  // namespace alidade::python
