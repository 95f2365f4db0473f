#include <unistd.h>

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/read_ahead.h"
#include "alidade/run/sources/any_source.h"
#include "arrays.h"
#include "values.h"

namespace alidade::python {
namespace {

// Reads a recording frame by frame. May be used from any thread; calls are serialized.
class Source {
 public:
  explicit Source(std::unique_ptr<FrameSource> source)
      : source_(std::make_unique<ReadAhead>(std::move(source))), info_(source_->Info()) {}
  ~Source() { Close(); }

  std::optional<SourceFrame> Next() {
    if (IsForked())
      ThrowUsage(
          "this recording is read by a thread, which a forked process does not have: open it in "
          "the "
          "process that uses it");
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!source_) return std::nullopt;
    return source_->Next();
  }
  void Close() {
    if (IsForked()) {
      static_cast<void>(source_.release());  // its thread, which would have to end, is not here
      return;
    }
    const py::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    source_.reset();
  }
  const SourceInfo& info() const { return info_; }
  bool IsForked() const { return process_ != getpid(); }

 private:
  const pid_t process_ = getpid();  // that has the thread
  std::mutex mutex_;
  std::unique_ptr<ReadAhead> source_;  // null after Close()
  SourceInfo info_;
};

std::unique_ptr<Source> Open(const py::dict& values, bool color) {
  const RunOptions options = OptionsFrom(values);
  SourceOptions wanted = SourceOptionsFrom(options);
  wanted.color = color;
  const py::gil_scoped_release release;
  return std::make_unique<Source>(OpenAnySource(options.source, wanted));
}

// Keyword arguments of alidade.Frame; None at the end.
py::object NextFrame(Source& source) {
  const std::optional<SourceFrame> frame = source.Next();
  if (!frame) return py::none();
  using py::literals::operator""_a;
  const py::object pose = frame->T_world_camera ? py::object(PoseArray(*frame->T_world_camera))
                                                : py::object(py::none());
  return py::dict(
      "time"_a = frame->time, "stamp"_a = frame->stamp, "number"_a = frame->number,
      "image"_a = ArrayOf(frame->image), "right"_a = ArrayOf(frame->right),
      "depth"_a = ArrayOf(frame->depth), "color"_a = ArrayOf(frame->color),
      "imu"_a = source.info().imu ? py::object(ImuArray(frame->imu)) : py::object(py::none()),
      "problem"_a = PathText(frame->problem), "true_pose"_a = pose,
      "true_depth"_a = ArrayOf(frame->true_depth));
}

py::dict InfoOf(const Source& source) {
  const SourceInfo& info = source.info();
  using py::literals::operator""_a;
  return py::dict("name"_a = PathText(info.name), "kind"_a = info.kind,
                  "sensor"_a = NameOf(info.sensor), "camera"_a = CameraObject(info.camera),
                  "imu"_a = info.imu ? ImuObject(*info.imu) : py::object(py::none()),
                  "camera_guessed"_a = info.camera_guessed, "frames"_a = info.frames,
                  "mounting"_a = PoseArray(Se3{info.R_camera_rectified, Eigen::Vector3d::Zero()}));
}

}  // namespace

void BindSource(py::module_& core) {
  py::class_<Source>(core, "Source")
      .def("next", &NextFrame)
      .def("info", &InfoOf)
      .def("close", &Source::Close);
  core.def("open", &Open, py::arg("options"), py::arg("color"));
}

}  // namespace alidade::python
