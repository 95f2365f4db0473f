#include "alidade/synth/recording.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/synth/actor.h"
#include "alidade/synth/renderer.h"
#include "alidade/synth/scenes/scenes.h"
#include "alidade/synth/sensor.h"
#include "alidade/synth/thing.h"

namespace alidade {
namespace {

constexpr double kMostGain = 4;     // largest exposure gain in low light
constexpr int kBlurSamples = 7;     // images averaged during the exposure
constexpr double kBaseline = 0.11;  // meters
constexpr double kDepthFactor = 5000;

Camera MakeCamera(const SynthSettings& settings) {
  Camera camera;
  camera.width = settings.width;
  camera.height = settings.height;
  camera.fx = camera.fy = settings.Focal();
  camera.cx = (settings.width - 1) / 2.0;
  camera.cy = (settings.height - 1) / 2.0;
  camera.distortion[0] = settings.k1;
  if (settings.distortion) camera.distortion = {-0.22, 0.09, 0.0006, -0.0004, 0};
  camera.fps = settings.fps;
  camera.depth_factor = kDepthFactor;
  camera.baseline = settings.stereo ? kBaseline : 0;
  camera.readout_known = true;
  camera.readout[1] = 1e-3 * settings.rolling_shutter;
  return camera;
}

RawCamera LensOf(const SynthSettings& settings, const Camera& camera) {
  RawCamera lens;
  lens.lens = settings.fisheye ? Lens::kFisheye : Lens::kPinhole;
  lens.width = camera.width;
  lens.height = camera.height;
  lens.fx = camera.fx;
  lens.fy = camera.fy;
  lens.cx = camera.cx;
  lens.cy = camera.cy;
  lens.distortion = camera.distortion;
  return lens;
}

// Slow drift of brightness and contrast, with means 1 and 0.
struct Drift {
  double gain = 1, bias = 0;  // factor; gray levels
  double noise = 0;           // gray levels
};
Drift ExposureAt(const SynthSettings& settings, double time) {
  if (!settings.exposure) return {};
  Random random(settings.seed, 41);
  const double a = random.Uniform(0, 6.28), b = random.Uniform(0, 6.28),
               c = random.Uniform(0, 6.28);
  return {1 + 0.18 * std::sin(0.9 * time + a) + 0.07 * std::sin(2.1 * time + b),
          9 * std::sin(0.6 * time + c), 0};
}

// Brightness relative to daylight, and the noise: relative to the signal it grows with 1 /
// sqrt(light).
Drift InThisLight(const SynthSettings& settings, Drift drift) {
  const double bright = std::min(1.0, kMostGain * settings.light);
  drift.gain *= bright;
  drift.bias *= bright;
  drift.noise = settings.noise * bright / std::sqrt(settings.light);
  return drift;
}

Layout LayOutFor(const SynthSettings& settings, SceneBuilder& builder) {
  const Layout layout = LayOut(settings.scene, builder);
  if (settings.path == "turn") return TurnOnTheSpot(layout, settings.arm);
  if (settings.path == "still") return StandStill(layout);
  return layout;
}

// Cumulative delay of each frame, seconds.
std::vector<double> DelaysOf(const SynthSettings& settings) {
  Random random(settings.seed, 61);
  std::vector<double> delays;
  double delay = 0;
  for (int i = 0; i < settings.frames; ++i) {
    if (i > 0 && random.Uniform() < settings.held) delay += random.Uniform(0.2, 1);
    delays.push_back(delay);
  }
  return delays;
}

PathTiming TimingOf(const SynthSettings& settings) {
  PathTiming timing;
  timing.speed = settings.speed;
  if (settings.path == "turn-walk") timing.turn_first = 4;
  return timing;
}

}  // namespace

struct SynthRecording::Parts {
  Parts(const SynthSettings& given, const Layout& layout, Scene built,
        const std::vector<ActorLooks>& looks, std::vector<Thing> moved)
      : settings(given),
        delays(DelaysOf(given)),
        camera(MakeCamera(given)),
        scene(std::move(built)),
        path(layout.knots, layout.period, layout.turns, layout.shake, given.seed, TimingOf(given)),
        actors(CastActors(looks, layout.walks, path, given.frames / given.fps + delays.back(),
                          given.seed)),
        things(std::move(moved)),
        renderer(scene, camera, given.fisheye) {
    if (given.imu == "off") return;
    imu = std::make_unique<SimulatedImu>(given, given.frames / given.fps + delays.back(),
                                         [this](double time) { return path.MotionAt(time); });
  }

  View Capture(double time, const Eigen::Vector3d& p_camera_eye) const {
    Shutter shutter;
    const double readout = 1e-3 * settings.rolling_shutter;
    shutter.rolling = readout > 0;
    const auto row_time = [this, time, readout](double row) {
      return readout > 0 ? time + readout * ((row + 0.5) / camera.height - 0.5) : time;
    };
    shutter.T_world_camera = [this, row_time, p_camera_eye](double row) {
      Se3 pose = path.At(row_time(row));
      pose.t = pose * p_camera_eye;
      return pose;
    };
    shutter.actors = [this, row_time](double row) {
      std::vector<Quadric> parts;
      for (const Actor& actor : actors) {
        for (const Quadric& part : actor.Body(row_time(row))) parts.push_back(part);
      }
      for (const Thing& thing : things) {
        for (const Quadric& part : thing.Parts(row_time(row))) parts.push_back(part);
      }
      return parts;
    };
    return renderer.Render(shutter);
  }

  // With blur: gray levels are the mean over the exposure, depth and actors those at its middle.
  View Look(double time, const Eigen::Vector3d& p_camera_eye) const {
    View view = Capture(time, p_camera_eye);
    if (settings.blur == 0) return view;
    const double open = 1e-3 * settings.blur;
    for (int i = 0; i < kBlurSamples; ++i) {
      if (i == kBlurSamples / 2) continue;
      view.grey += Capture(time + open * ((i + 0.5) / kBlurSamples - 0.5), p_camera_eye).grey;
    }
    view.grey /= kBlurSamples;
    return view;
  }

  SynthSettings settings;
  std::vector<double> delays;
  Camera camera;
  Scene scene;
  CameraPath path;
  std::vector<Actor> actors;
  std::vector<Thing> things;
  ViewRenderer renderer;
  std::unique_ptr<SimulatedImu> imu;
};

SynthRecording::SynthRecording(SynthSettings settings) {
  settings.Check();
  SceneBuilder builder(settings.seed);
  const Layout layout = LayOutFor(settings, builder);
  if (settings.things > 0 && !layout.table)
    ThrowUsage("synth: things need a table, which the scene does not have: \"" + settings.scene +
               "\"");
  std::vector<ActorLooks> looks;
  // Separate stream: the scene is the same with and without people.
  Random random(settings.seed, 51);
  for (int i = 0; i < settings.actors; ++i) looks.push_back(DressActor(builder, random));
  std::vector<Thing> things;
  if (settings.things > 0)
    things = PutThings(builder, *layout.table, settings.things, settings.seed);
  parts_ = std::make_unique<Parts>(settings, layout, builder.Build(), looks, std::move(things));
}
SynthRecording::~SynthRecording() = default;
SynthRecording::SynthRecording(SynthRecording&&) noexcept = default;
SynthRecording& SynthRecording::operator=(SynthRecording&&) noexcept = default;

const SynthSettings& SynthRecording::settings() const { return parts_->settings; }
const Camera& SynthRecording::camera() const { return parts_->camera; }
RawCamera SynthRecording::lens() const { return LensOf(parts_->settings, parts_->camera); }
int SynthRecording::frames() const { return parts_->settings.frames; }
double SynthRecording::Time(int number) const {
  const int last = parts_->settings.frames - 1;
  return number / parts_->settings.fps + parts_->delays[std::clamp(number, 0, last)];
}
Se3 SynthRecording::Pose(int number) const { return parts_->path.At(Time(number)); }
const SimulatedImu* SynthRecording::imu() const { return parts_->imu.get(); }

RenderedFrame SynthRecording::Render(int number) const {
  const SynthSettings& settings = parts_->settings;
  RenderedFrame frame;
  frame.time = Time(number);
  const Drift drift = InThisLight(settings, ExposureAt(settings, frame.time));
  const View left = parts_->Look(frame.time, Eigen::Vector3d::Zero());
  frame.clean = left.grey;
  frame.image =
      ExposeImage(left.grey, drift.gain, drift.bias, drift.noise, {settings.seed, number, 0});
  frame.depth_exact = left.depth;
  frame.mask = left.actor;
  frame.depth = SenseDepth(left.depth, parts_->camera.fx, kDepthFactor, {settings.seed, number, 2});
  if (settings.stereo) {
    const View right = parts_->Look(frame.time, {kBaseline, 0, 0});
    frame.right =
        ExposeImage(right.grey, drift.gain, drift.bias, drift.noise, {settings.seed, number, 1});
  }
  return frame;
}

}  // namespace alidade
