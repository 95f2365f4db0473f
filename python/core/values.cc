#include "values.h"

#include <array>
#include <map>
#include <optional>

#include "alidade/base/error.h"
#include "arrays.h"
#include "detector.h"

namespace alidade::python {
namespace {

// What is short as it is written in Python, else its kind.
std::string InWords(const py::handle& value) {
  const bool plain = py::isinstance<py::str>(value) || py::isinstance<py::bytes>(value) ||
                     py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value);
  return plain ? py::repr(value).cast<std::string>() : Described(value);
}

template <typename T>
T Value(const std::string& name, const py::handle& value) {
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    ThrowUsage(name + " cannot be " + InWords(value));
  }
}

// Numbers and bools as they are written on the command line; paths as bytes.
std::string Word(const std::string& name, const py::handle& value) {
  if (py::hasattr(value, "__len__") && !py::isinstance<py::str>(value) &&
      !py::isinstance<py::bytes>(value))  // an array, a list
    ThrowUsage(name + " cannot be " + InWords(value));
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "1" : "0";
  if (py::isinstance<py::bytes>(value)) return value.cast<std::string>();
  const auto bytes =
      py::reinterpret_steal<py::object>(PyUnicode_EncodeFSDefault(py::str(value).ptr()));
  if (!bytes) {
    PyErr_Clear();
    ThrowUsage(py::repr(value).cast<std::string>() + " has no encoding");
  }
  return bytes.cast<std::string>();
}

template <typename T>
T Member(const py::handle& object, const char* name, const std::string& of = "camera") {
  return Value<T>(of + "." + name, object.attr(name));
}

void SetOption(RunOptions& options, const std::string& name, const py::handle& value) {
  const std::map<std::string, std::optional<std::string>*> words = {
      {"sensor", &options.sensor},     {"camera_file", &options.camera_file},
      {"config", &options.config},     {"schedule", &options.schedule},
      {"rate", &options.rate},         {"out", &options.out},
      {"load", &options.load},         {"fov", &options.fov},
      {"dynamics", &options.dynamics}, {"record_to", &options.record_to},
      {"port", &options.port},         {"host", &options.host},
      {"mask", &options.mask},         {"imu", &options.imu}};
  const std::map<std::string, bool*> switches = {{"calibrate_first", &options.calibrate_first},
                                                 {"localize", &options.localize},
                                                 {"overwrite", &options.overwrite},
                                                 {"record", &options.record},
                                                 {"viewer", &options.viewer},
                                                 {"semidense", &options.semidense},
                                                 {"write_masks", &options.write_masks}};
  const std::map<std::string, int*> numbers = {{"threads", &options.threads},
                                               {"first", &options.first},
                                               {"last", &options.last},
                                               {"repeat", &options.repeat}};
  if (const auto word = words.find(name); word != words.end()) {
    *word->second = Word(name, value);
  } else if (const auto flag = switches.find(name); flag != switches.end()) {
    *flag->second = Value<bool>(name, value);
  } else if (const auto number = numbers.find(name); number != numbers.end()) {
    *number->second = Value<int>(name, value);
  } else if (name == "source") {
    options.source = Word(name, value);
  } else if (name == "profile") {
    options.profile = Word(name, value);
  } else if (name == "seed") {
    options.seed = Value<uint64_t>(name, value);
  } else if (name == "settings") {
    for (const auto& [setting, content] : Value<py::dict>(name, value))
      options.settings.push_back(Word("the name of a setting", setting) + "=" +
                                 Word(Word(name, setting), content));
  } else if (name == "detector") {
    if (PyCallable_Check(value.ptr()) != 0) {
      options.own_detector = DetectorOf(py::reinterpret_borrow<py::object>(value));
    } else {
      options.detector = Word(name, value);
    }
  } else {
    ThrowUsage("there is no option '" + name + "'");
  }
}

}  // namespace

py::str PathText(const std::string& text) {
  PyObject* decoded =
      PyUnicode_DecodeFSDefaultAndSize(text.data(), static_cast<Py_ssize_t>(text.size()));
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

Camera CameraFrom(const py::handle& value) {
  Camera camera;
  camera.width = Member<int>(value, "width");
  camera.height = Member<int>(value, "height");
  camera.fx = Member<double>(value, "fx");
  camera.fy = Member<double>(value, "fy");
  camera.cx = Member<double>(value, "cx");
  camera.cy = Member<double>(value, "cy");
  camera.distortion = Member<std::array<double, 5>>(value, "distortion");
  camera.fps = Member<double>(value, "fps");
  camera.depth_factor = Member<double>(value, "depth_factor");
  camera.baseline = Member<double>(value, "baseline");
  camera.readout_known = !value.attr("readout").is_none();
  if (camera.readout_known) camera.readout = Member<std::array<double, 2>>(value, "readout");
  camera.Check();
  return camera;
}

py::object CameraObject(const Camera& camera) {
  const py::object type = py::module_::import("alidade.camera").attr("Camera");
  const auto& d = camera.distortion;
  const py::object readout = camera.readout_known || camera.RollingShutter()
                                 ? py::object(py::make_tuple(camera.readout[0], camera.readout[1]))
                                 : py::object(py::none());
  using py::literals::operator""_a;
  return type("width"_a = camera.width, "height"_a = camera.height, "fx"_a = camera.fx,
              "fy"_a = camera.fy, "cx"_a = camera.cx, "cy"_a = camera.cy,
              "distortion"_a = py::make_tuple(d[0], d[1], d[2], d[3], d[4]), "fps"_a = camera.fps,
              "depth_factor"_a = camera.depth_factor, "baseline"_a = camera.baseline,
              "readout"_a = readout);
}

ImuModel ImuFrom(const py::handle& value) {
  const auto number = [&](const char* name) { return Member<double>(value, name, "imu"); };
  ImuModel imu;
  imu.rate = number("rate");
  imu.noise = {number("gyro_noise"), number("accel_noise"), number("gyro_walk"),
               number("accel_walk")};
  imu.time_offset_known = !value.attr("time_offset").is_none();
  if (imu.time_offset_known) imu.time_offset = number("time_offset");
  imu.rotation_known = imu.translation_known = !value.attr("T_camera_imu").is_none();
  if (imu.rotation_known)
    imu.T_camera_imu = PoseFrom(value.attr("T_camera_imu"), "imu.T_camera_imu");
  imu.Check();
  return imu;
}

py::object ImuObject(const ImuModel& imu) {
  const py::object type = py::module_::import("alidade.imu").attr("Imu");
  using py::literals::operator""_a;
  const py::object none = py::none();
  return type(
      "T_camera_imu"_a = imu.rotation_known ? py::object(PoseArray(imu.T_camera_imu)) : none,
      "rate"_a = imu.rate, "gyro_noise"_a = imu.noise.gyro, "accel_noise"_a = imu.noise.accel,
      "gyro_walk"_a = imu.noise.gyro_walk, "accel_walk"_a = imu.noise.accel_walk,
      "time_offset"_a = imu.time_offset_known ? py::object(py::float_(imu.time_offset)) : none);
}

RunOptions OptionsFrom(const py::dict& values) {
  RunOptions options;
  for (const auto& [name, value] : values) {
    if (!value.is_none()) SetOption(options, name.cast<std::string>(), value);
  }
  return options;
}

}  // namespace alidade::python
