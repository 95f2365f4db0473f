#include "alidade/run/sources/synth_source.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/base/print.h"
#include "alidade/io/calibration.h"
#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/text.h"
#include "alidade/io/wrappers.h"
#include "alidade/run/sources/flight_files.h"
#include "alidade/synth/recording.h"

namespace alidade {
namespace {

constexpr char kPrefix[] = "synth:";
constexpr double kImuBefore = 0.1;  // seconds of readings before the first frame

double Number(const std::string& name, const std::string& value, bool whole) {
  const std::optional<double> number = ParseNumber(value);
  if (!number || !(*number >= -1e9 && *number <= 9e15) ||
      (whole && *number != static_cast<double>(static_cast<int64_t>(*number)))) {
    ThrowUsage("synth: " + name + " cannot be \"" + value + "\": it must be a " +
               (whole ? "whole " : "") + "number");
  }
  return *number;
}

int Whole(const std::string& name, const std::string& value) {
  const double number = Number(name, value, true);
  if (number < -1e9 || number > 1e9) ThrowUsage("synth: " + name + " is out of range: " + value);
  return static_cast<int>(number);
}

bool Switch(const std::string& name, const std::string& value) {
  if (value.empty() || value == "1" || value == "true") return true;
  if (value == "0" || value == "false") return false;
  ThrowUsage("synth: " + name + " cannot be \"" + value + "\": it is 0 or 1");
}

using Setter = std::function<void(SynthSettings&, const std::string&, const std::string&)>;

Setter Into(int SynthSettings::*field) {
  return [field](SynthSettings& settings, const std::string& name, const std::string& value) {
    settings.*field = Whole(name, value);
  };
}

Setter Into(double SynthSettings::*field) {
  return [field](SynthSettings& settings, const std::string& name, const std::string& value) {
    settings.*field = Number(name, value, false);
  };
}

Setter Into(bool SynthSettings::*field) {
  return [field](SynthSettings& settings, const std::string& name, const std::string& value) {
    settings.*field = Switch(name, value);
  };
}

// A switch with value `usual`, or a number above 1.
Setter Into(double SynthSettings::*field, double usual) {
  return
      [field, usual](SynthSettings& settings, const std::string& name, const std::string& value) {
        const bool number = !value.empty() && value != "1" && value != "true" && value != "false";
        settings.*field = number ? Number(name, value, false) : (Switch(name, value) ? usual : 0);
      };
}

void SetSeed(SynthSettings& settings, const std::string& name, const std::string& value) {
  const double seed = Number(name, value, true);
  if (seed < 0) ThrowUsage("synth: seed cannot be negative");
  settings.seed = static_cast<uint64_t>(seed);
}

Setter Into(std::string SynthSettings::*field) {
  return [field](SynthSettings& settings, const std::string&, const std::string& value) {
    settings.*field = value;
  };
}

void SetImuOffset(SynthSettings& settings, const std::string& name, const std::string& value) {
  settings.imu_offset = Number(name, value, false);
}

void Set(SynthSettings& settings, const std::string& name, const std::string& value) {
  using S = SynthSettings;
  static const std::vector<std::pair<std::string, Setter>> kOptions = {
      {"frames", Into(&S::frames)},
      {"path", Into(&S::path)},
      {"speed", Into(&S::speed)},
      {"arm", Into(&S::arm)},
      {"actors", Into(&S::actors)},
      {"things", Into(&S::things)},
      {"noise", Into(&S::noise)},
      {"light", Into(&S::light)},
      {"blur", Into(&S::blur, S::kUsualBlur)},
      {"exposure", Into(&S::exposure)},
      {"distortion", Into(&S::distortion)},
      {"k1", Into(&S::k1)},
      {"fisheye", Into(&S::fisheye)},
      {"rolling", Into(&S::rolling_shutter, S::kUsualRolling)},
      {"rolling_shutter", Into(&S::rolling_shutter)},
      {"stereo", Into(&S::stereo)},
      {"seed", SetSeed},
      {"width", Into(&S::width)},
      {"height", Into(&S::height)},
      {"fov", Into(&S::fov)},
      {"fps", Into(&S::fps)},
      {"held", Into(&S::held)},
      {"calibrated", Into(&S::calibrated)},
      {"imu", Into(&S::imu)},
      {"imu_rate", Into(&S::imu_rate)},
      {"imu_offset", SetImuOffset},
      {"imu_model", Into(&S::imu_model)}};
  std::vector<std::string> names;
  for (const auto& [known, set] : kOptions) {
    if (known == name) {
      set(settings, name, value);
      return;
    }
    names.push_back(known);
  }
  ThrowUsage("synth: unknown option \"" + name + "\"" + DidYouMean(name, names));
}

Calibration RenderedCalibration(const Camera& camera, const RawCamera& lens) {
  Calibration calibration;
  calibration.left = lens;
  calibration.baseline = camera.baseline;
  calibration.fps = camera.fps;
  calibration.depth_factor = camera.depth_factor;
  return calibration;
}

// The camera given by the user, if any.
Calibration ToldCalibration(const SynthRecording& recording, const SourceOptions& options) {
  const Camera& camera = recording.camera();
  const Calibration own = RenderedCalibration(camera, recording.lens());
  if (options.camera_file && options.fov_degrees) ThrowUsage("give either --camera or --fov");
  Calibration chosen = own;
  if (options.fov_degrees || !recording.settings().calibrated) {
    const double assumed = AssumedFov({camera.width, camera.height});
    chosen = GuessedCalibration(camera.width, camera.height, options.fov_degrees.value_or(assumed));
  }
  if (options.camera_file)
    chosen = FitToSize(ReadCameraFile(*options.camera_file), {camera.width, camera.height});
  if (!options.camera_file) chosen.baseline = own.baseline;
  if (!options.camera_file || !chosen.fps) chosen.fps = own.fps;
  if (!chosen.depth_factor) chosen.depth_factor = own.depth_factor;
  return chosen;
}

Sensor ChooseSensor(const SynthSettings& settings, const SourceOptions& options) {
  const Sensor sensor = options.sensor.value_or(settings.stereo ? Sensor::kStereo : Sensor::kRgbd);
  if (sensor == Sensor::kStereo && !settings.stereo) {
    ThrowUsage(
        "--sensor stereo: the rendered recording has no second camera (add ?stereo to the source)");
  }
  return sensor;
}

class SynthSource : public ActorSource {
 public:
  SynthSource(SynthSettings settings, const SourceOptions& options)
      : recording_(MakeSynthRecording(settings)),
        calibration_(ToldCalibration(recording_, options)),
        preparation_(calibration_, ChooseSensor(settings, options)) {
    info_.told = calibration_.told;
    info_.name = "synth-" + settings.scene;
    info_.kind = "synth";
    info_.sensor = ChooseSensor(settings, options);
    info_.camera = preparation_.camera();
    info_.camera_guessed =
        !options.camera_file && (options.fov_degrees ? options.fov_rough : !settings.calibrated);
    info_.R_camera_rectified = preparation_.R_camera_rectified();
    info_.frames = recording_.frames();
    if (const ImuTrack* imu = recording_.imu()) {
      info_.imu = imu->told();
      const Eigen::Matrix3d R = info_.R_camera_rectified.transpose();
      if (info_.imu->rotation_known)
        info_.imu->T_camera_imu = Se3{R, Eigen::Vector3d::Zero()} * info_.imu->T_camera_imu;
    }
  }

  const SourceInfo& Info() const override { return info_; }

  std::optional<SourceFrame> Next() override {
    if (next_ >= info_.frames) return std::nullopt;
    const RenderedFrame rendered = recording_.Render(next_);
    SourceFrame frame;
    frame.time = rendered.time;
    frame.stamp = SynthStamp(rendered.time);
    frame.T_world_camera = recording_.Pose(next_);
    frame.number = next_++;
    frame.imu = ReadingsUntil(frame.number);
    frame.image = preparation_.Left(rendered.image);
    frame.true_depth = preparation_.Depth(rendered.depth_exact);
    if (info_.sensor == Sensor::kStereo) frame.right = preparation_.Right(rendered.right);
    if (info_.sensor == Sensor::kRgbd) frame.depth = preparation_.Depth(rendered.depth);
    mask_ = preparation_.Depth(rendered.mask);
    return frame;
  }

  cv::Mat ActorMask() const override { return mask_; }

  bool Seek(int frames) override {
    next_ = frames;
    after_ = -1;
    return true;
  }

 private:
  // Since the frame before; of the first frame that is played, since kImuBefore earlier at least.
  std::vector<ImuSample> ReadingsUntil(int number) {
    if (recording_.imu() == nullptr) return {};
    double from = number > 0 ? recording_.Time(number - 1) : recording_.Time(0) - kImuBefore;
    if (after_ != number - 1 || number == 0)
      from = std::min(from, recording_.Time(number) - kImuBefore);
    after_ = number;
    const double offset = info_.imu->time_offset;
    return recording_.imu()->Between(from + offset, recording_.Time(number) + offset);
  }

  SynthRecording recording_;
  Calibration calibration_;
  ImagePreparation preparation_;
  SourceInfo info_;
  cv::Mat mask_;
  int next_ = 0;
  int after_ = -1;  // number of the frame returned last; -1: none, or another than the one before
};

}  // namespace

SynthRecording MakeSynthRecording(const SynthSettings& settings) {
  settings.Check();
  if (settings.scene != kFlightScene) return SynthRecording(settings);
  return {settings, ReadFlight(settings)};
}

std::string SynthStamp(double seconds) {
  char text[40];
  PrintTo(text, sizeof(text), "%.6f", seconds);
  return text;
}

bool IsSynthSource(const std::string& source) { return source.rfind(kPrefix, 0) == 0; }

SynthSettings ParseSynthSource(const std::string& source) {
  if (!IsSynthSource(source)) ThrowUsage("not a rendered source: " + source);
  std::string rest = source.substr(sizeof(kPrefix) - 1);
  const size_t question = rest.find('?');
  SynthSettings settings = SynthDefaults(rest.substr(0, question));
  rest = question == std::string::npos ? "" : rest.substr(question + 1);
  while (!rest.empty()) {
    const size_t end = rest.find('&');
    const std::string item = rest.substr(0, end);
    rest = end == std::string::npos ? "" : rest.substr(end + 1);
    if (item.empty()) continue;
    const size_t equals = item.find('=');
    std::string name = item.substr(0, equals);
    std::replace(name.begin(), name.end(), '-', '_');
    const std::string value = equals == std::string::npos ? "" : item.substr(equals + 1);
    Set(settings, name, value);
  }
  settings.Check();
  return settings;
}

std::unique_ptr<ActorSource> OpenActorSource(const std::string& source,
                                             const SourceOptions& options) {
  const SynthSettings settings = ParseSynthSource(source);
  ChooseSensor(settings, options);
  return std::make_unique<SynthSource>(settings, options);
}

std::unique_ptr<FrameSource> OpenSynthSource(const std::string& source,
                                             const SourceOptions& options) {
  const SynthSettings settings = ParseSynthSource(source);
  ChooseSensor(settings, options);  // before anything is rendered
  return Clip(std::make_unique<SynthSource>(settings, options), options.first, options.last);
}

}  // namespace alidade
