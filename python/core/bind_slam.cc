#include "slam_object.h"
#include "values.h"

namespace alidade::python {
namespace {

using py::literals::operator""_a;

const char* StateOf(const TrackedFrame& frame) { return StateName(frame.result.state); }

bool IsTracked(const TrackedFrame& frame) { return frame.result.state == TrackState::kTracking; }

py::object PoseOf(const TrackedFrame& frame) {
  return IsTracked(frame) ? py::object(PoseArray(frame.result.T_world_camera))
                          : py::object(py::none());
}

py::object PredictedOf(const TrackedFrame& frame) {
  return frame.result.predicted ? py::object(PoseArray(*frame.result.predicted))
                                : py::object(py::none());
}

py::object OrientationOf(const TrackedFrame& frame) {
  const std::optional<CameraOrientation>& orientation = frame.result.orientation;
  if (!orientation) return py::none();
  py::array_t<double> array({3, 3});
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      *array.mutable_data(row, column) = orientation->R_world_camera(row, column);
  }
  return py::make_tuple(array, orientation->tilt_sigma, orientation->heading_sigma);
}

py::object FailureOf(const TrackedFrame& frame) {
  const TrackFailure failure = frame.result.failure;
  return failure == TrackFailure::kNone ? py::object(py::none())
                                        : py::object(py::str(FailureName(failure)));
}

// Keyword arguments of alidade.TrackResult.
py::dict FieldsOf(const TrackedFrame& frame) {
  const TrackResult& result = frame.result;
  return py::dict(
      "frame"_a = frame.frame, "time"_a = frame.time, "state"_a = StateOf(frame),
      "pose"_a = PoseOf(frame), "failure"_a = FailureOf(frame), "reason"_a = result.reason(),
      "matches"_a = result.matches, "covariance"_a = CovarianceArray(result.quality.covariance),
      "keyframe"_a = result.keyframe, "predicted"_a = PredictedOf(frame),
      "orientation"_a = OrientationOf(frame), "cut"_a = result.cut,
      "expected"_a = result.quality.expected, "inliers"_a = result.quality.inliers,
      "found_share"_a = result.quality.found_share, "probability"_a = result.quality.probability,
      "warning"_a = PathText(result.warning));
}

}  // namespace

void BindSlam(py::module_& core) {
  py::class_<SlamObject>(core, "Slam")
      .def(py::init<const py::object&, const py::dict&, const py::object&, bool,
                    const py::object&>(),
           "camera"_a, "options"_a, "mounting"_a, "calibrate"_a, "imu"_a)
      .def("track",
           [](SlamObject& slam, double time, const py::object& image, const py::object& depth,
              const py::object& right, const py::object& color, const py::object& imu,
              const std::string& stamp) {
             return FieldsOf(slam.Track(time, image, depth, right, color, imu, stamp));
           })
      .def("load", &SlamObject::Load)
      .def("leave_out", &SlamObject::LeaveOut)
      .def("reset", &SlamObject::Reset)
      .def("forget", &SlamObject::Forget)
      .def("set_mapping", &SlamObject::SetMapping)
      .def("finish", &SlamObject::Finish)
      .def("view", &SlamObject::View, "port"_a, "host"_a)
      .def("record", &SlamObject::Record)
      .def("end_record", &SlamObject::EndRecord)
      .def("close", &SlamObject::Close)
      .def_property_readonly("closed", &SlamObject::closed)
      .def("camera", &SlamObject::camera)
      .def("focal_sigma", &SlamObject::focal_sigma)
      .def("settings", &SlamObject::settings)
      .def("frames", &SlamObject::frames)
      .def("trajectory", &SlamObject::Trajectory)
      .def("trajectory_text", &SlamObject::TrajectoryText)
      .def("frame_poses", &SlamObject::Frames)
      .def("map", &SlamObject::Map)
      .def("health", &SlamObject::Health)
      .def("inertial", &SlamObject::Inertial)
      .def("counts", &SlamObject::Counts)
      .def("times", &SlamObject::Times)
      .def("features", &SlamObject::Features)
      .def("mover_mask", &SlamObject::MoverMask)
      .def("detections", &SlamObject::Detections);
}

}  // namespace alidade::python
