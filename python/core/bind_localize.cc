#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "alidade/io/files/camera_file.h"
#include "alidade/localize/localizer.h"
#include "alidade/run/sources/saved_map.h"
#include "arrays.h"
#include "map_value.h"
#include "values.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;

// The library's Localizer, which tells maps by their index in Map.parts.
class PictureLocalizer {
 public:
  explicit PictureLocalizer(const MapValue& map) : localizer_(map) {
    for (const MapPart& part : PartsOf(map.map))
      maps_.push_back(map.map.MapOf(part.keyframes.front()));
  }

  // `camera`: an alidade.Camera, or the path of a camera file (bytes), which may be a fisheye's.
  py::dict Localize(const py::handle& image, const py::object& camera,
                    double min_probability) const {
    const WrappedImage picture = WrapImage(image, "image");
    const Calibration calibration = py::isinstance<py::bytes>(camera)
                                        ? ReadCameraFile(camera.cast<std::string>())
                                        : CalibrationOf(CameraFrom(camera));
    Placement found;
    {
      const py::gil_scoped_release release;
      found = localizer_.Localize(picture.image, calibration, min_probability);
    }
    return FieldsOf(found);
  }

 private:
  // Keyword arguments of alidade.Placement.
  py::dict FieldsOf(const Placement& found) const {
    py::object pose = py::none(), covariance = py::none(), part = py::none(), keyframe = py::none();
    if (found.keyframe.valid()) {  // placed, or the best guess
      pose = PoseArray(found.T_world_camera);
      covariance = CovarianceArray(found.covariance);
      part = py::int_(std::find(maps_.begin(), maps_.end(), found.map) - maps_.begin());
      keyframe = py::int_(found.keyframe.value);
    }
    return py::dict("placed"_a = found.placed(), "pose"_a = pose, "covariance"_a = covariance,
                    "probability"_a = found.probability, "reason"_a = NameOf(found.why),
                    "why"_a = WordsOf(found.why), "metric"_a = found.meters, "part"_a = part,
                    "keyframe"_a = keyframe, "expected"_a = found.expected,
                    "inliers"_a = found.inliers, "agreement"_a = found.agreement,
                    "keypoints"_a = found.keypoints);
  }

  Localizer localizer_;
  std::vector<MapId> maps_;  // of the parts
};

}  // namespace

void BindLocalize(py::module_& core) {
  py::class_<PictureLocalizer>(core, "Localizer")
      .def(py::init([](const MapHolder& map) {
             const py::gil_scoped_release release;
             return std::make_unique<PictureLocalizer>(*map);
           }),
           "map"_a)
      .def("localize", &PictureLocalizer::Localize, "image"_a, "camera"_a, "min_probability"_a);
}

}  // namespace alidade::python
