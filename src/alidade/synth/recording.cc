#include "alidade/synth/recording.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/synth/actor.h"
#include "alidade/synth/imu.h"
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

// Where the camera is and what is there; times are in seconds.
struct RenderedWorld {
  SynthSettings settings;
  Scene scene;
  std::function<Se3(double time)> T_scene_camera;
  // The scene's origin in the world of SynthRecording::Pose(), meters.
  Eigen::Vector3d p_world_scene = Eigen::Vector3d::Zero();
  std::function<double(int number)> time_of;  // of any frame
  std::vector<Actor> actors;
  std::vector<Thing> things;
  std::unique_ptr<ImuTrack> imu;
};

namespace {

RenderedWorld MakeWorld(SynthSettings settings) {
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
  RenderedWorld world;
  world.settings = settings;
  if (settings.things > 0)
    world.things = PutThings(builder, *layout.table, settings.things, settings.seed);
  world.scene = builder.Build();
  const std::vector<double> delays = DelaysOf(settings);
  world.time_of = [delays, fps = settings.fps](int number) {
    return number / fps + delays[std::clamp(number, 0, static_cast<int>(delays.size()) - 1)];
  };
  const CameraPath path(layout.knots, layout.period, layout.turns, layout.shake, settings.seed,
                        TimingOf(settings));
  const double seconds = settings.frames / settings.fps + delays.back();
  world.actors = CastActors(looks, layout.walks, path, seconds, settings.seed);
  world.T_scene_camera = [path](double time) { return path.At(time); };
  if (settings.imu != "off")
    world.imu = std::make_unique<SimulatedImu>(settings, seconds,
                                               [path](double time) { return path.MotionAt(time); });
  return world;
}

RenderedWorld MakeWorld(SynthSettings settings, Flight flight) {
  settings.scene = kFlightScene;
  settings.Check();
  flight.Check();
  settings.fps = flight.Fps();
  const int count = static_cast<int>(flight.poses.size());
  settings.frames = settings.frames == 0 ? count : std::min(settings.frames, count);
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> times;
  for (const FlightPose& pose : flight.poses) {
    positions.push_back(pose.T_world_camera.t);
    times.push_back(pose.time);
  }
  SceneBuilder builder(settings.seed);
  RenderedWorld world;
  world.settings = settings;
  world.p_world_scene = LayOutFlight(builder, positions);
  world.scene = builder.Build();
  world.time_of = [times, count](int number) { return times[std::clamp(number, 0, count - 1)]; };
  const FlightPath path(std::move(flight.poses));
  world.T_scene_camera = [path, origin = world.p_world_scene](double time) {
    Se3 pose = path.At(time);
    pose.t -= origin;
    return pose;
  };
  if (!flight.readings.empty())
    world.imu = std::make_unique<RecordedImu>(std::move(flight.readings), flight.imu);
  return world;
}

}  // namespace

struct SynthRecording::Parts : RenderedWorld {
  explicit Parts(RenderedWorld world)
      : RenderedWorld(std::move(world)),
        camera(MakeCamera(settings)),
        renderer(scene, camera, settings.fisheye) {}

  View Capture(double time, const Eigen::Vector3d& p_camera_eye) const {
    Shutter shutter;
    const double readout = 1e-3 * settings.rolling_shutter;
    shutter.rolling = readout > 0;
    const auto row_time = [this, time, readout](double row) {
      return readout > 0 ? time + readout * ((row + 0.5) / camera.height - 0.5) : time;
    };
    shutter.T_world_camera = [this, row_time, p_camera_eye](double row) {
      Se3 pose = T_scene_camera(row_time(row));
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

  Camera camera;
  ViewRenderer renderer;
};

SynthRecording::SynthRecording(SynthSettings settings)
    : parts_(std::make_unique<Parts>(MakeWorld(std::move(settings)))) {}
SynthRecording::SynthRecording(SynthSettings settings, Flight flight)
    : parts_(std::make_unique<Parts>(MakeWorld(std::move(settings), std::move(flight)))) {}
SynthRecording::~SynthRecording() = default;
SynthRecording::SynthRecording(SynthRecording&&) noexcept = default;
SynthRecording& SynthRecording::operator=(SynthRecording&&) noexcept = default;

const SynthSettings& SynthRecording::settings() const { return parts_->settings; }
const Camera& SynthRecording::camera() const { return parts_->camera; }
RawCamera SynthRecording::lens() const { return LensOf(parts_->settings, parts_->camera); }
int SynthRecording::frames() const { return parts_->settings.frames; }
double SynthRecording::Time(int number) const { return parts_->time_of(number); }
Se3 SynthRecording::Pose(int number) const {
  Se3 pose = parts_->T_scene_camera(Time(number));
  pose.t += parts_->p_world_scene;
  return pose;
}

const ImuTrack* SynthRecording::imu() const { return parts_->imu.get(); }

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
