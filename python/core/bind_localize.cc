#include <memory>
#include <string>

#include "alidade/io/files/camera_file.h"
#include "alidade/localize/localizer.h"
#include "arrays.h"
#include "map_value.h"
#include "values.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;

// Keyword arguments of alidade.Placement.
py::dict FieldsOf(const Placement& found) {
  const bool guess = found.placed() || found.probability > 0;
  return py::dict(
      "placed"_a = found.placed(),
      "pose"_a = guess ? py::object(PoseArray(found.T_world_camera)) : py::object(py::none()),
      "covariance"_a = guess ? CovarianceArray(found.covariance) : py::object(py::none()),
      "probability"_a = found.probability, "reason"_a = NameOf(found.why),
      "why"_a = WordsOf(found.why), "metric"_a = found.meters, "part"_a = found.map.value,
      "keyframe"_a = guess ? py::object(py::int_(found.keyframe.value)) : py::object(py::none()),
      "expected"_a = found.expected, "inliers"_a = found.inliers, "agreement"_a = found.agreement,
      "keypoints"_a = found.keypoints);
}

// The picture of a camera that is an alidade.Camera or a file (bytes), which may be a fisheye's.
py::dict Localize(const Localizer& localizer, const py::handle& image, const py::object& camera,
                  double min_probability) {
  const WrappedImage picture = WrapImage(image, "image");
  Calibration calibration = py::isinstance<py::bytes>(camera)
                                ? ReadCameraFile(camera.cast<std::string>())
                                : CalibrationOf(CameraFrom(camera));
  Placement found;
  {
    const py::gil_scoped_release release;
    found = localizer.Localize(picture.image, calibration, min_probability);
  }
  return FieldsOf(found);
}

}  // namespace

void BindLocalize(py::module_& core) {
  py::class_<Localizer, std::unique_ptr<Localizer>>(core, "Localizer")
      .def(py::init([](const MapHolder& map) {
             const py::gil_scoped_release release;
             return std::make_unique<Localizer>(*map);
           }),
           "map"_a)
      .def("localize", &Localize, "image"_a, "camera"_a, "min_probability"_a);
}

}  // namespace alidade::python
