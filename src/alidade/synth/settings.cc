#include "alidade/synth/settings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "alidade/base/error.h"

namespace alidade {
namespace {

struct NamedScene {
  const char* name;
  int frames;
};
constexpr NamedScene kScenes[] = {
    {"room", 600},    {"desk", 600},  {"corridor", 1000}, {"wall", 600},  {"loop", 2000},
    {"street", 1320}, {"road", 1987}, {"table", 360},     {"blank", 420}, {"hall", 840}};
constexpr const char* kPaths[] = {"walk", "turn", "turn-walk", "still"};
constexpr const char* kImus[] = {"off", "adis", "phone", "ideal"};

}  // namespace

std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

std::vector<std::string> PathNames() { return {std::begin(kPaths), std::end(kPaths)}; }

std::vector<std::string> ImuNames() { return {std::begin(kImus), std::end(kImus)}; }

int SceneFrames(const std::string& name) {
  if (name == kFlightScene) return 0;
  for (const NamedScene& scene : kScenes) {
    if (name == scene.name) return scene.frames;
  }
  std::string known;
  for (const NamedScene& scene : kScenes)
    known += std::string(known.empty() ? "" : ", ") + scene.name;
  ThrowUsage("synth: unknown scene \"" + name + "\"; known are " + known + ", " + kFlightScene);
}

SynthSettings SynthDefaults(const std::string& scene) {
  SynthSettings settings;
  settings.scene = scene;
  settings.frames = SceneFrames(scene);
  if (scene != kFlightScene) return settings;
  settings.width = 752;
  settings.height = 480;
  settings.fov = 78.77;  // a focal length of 458 pixels
  return settings;
}

double SynthSettings::Focal() const {
  if (fov == 0) return 525.0 * width / 640;  // 62.7°, as Kinect-like cameras have
  const double half = fov / 2 * std::numbers::pi / 180;
  return fisheye ? width / 2.0 / half : width / 2.0 / std::tan(half);
}

double SynthSettings::ImuRate() const {
  if (imu == "off") return 0;
  return imu_rate > 0 ? imu_rate : imu == "phone" ? 60 : 200;
}

void SynthSettings::Check() const {
  SceneFrames(scene);
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("synth: ") + what);
  };
  const bool flight = scene == kFlightScene;
  require(frames >= (flight ? 0 : 1) && frames <= 1000000, "frames must be between 1 and 1000000");
  const std::vector<std::string> paths = PathNames();
  const bool named = std::find(paths.begin(), paths.end(), path) != paths.end();
  require(flight || named, "path must be walk, turn, turn-walk or still");
  require(!flight || (!named && !path.empty()),
          "a flight needs a file with the poses of the camera: path=FILE");
  require(!flight || (actors == 0 && things == 0 && speed == 1 && held == 0),
          "a flight is as it was recorded: actors, things, speed and held are not for it");
  require(speed > 0 && speed <= 100, "speed must be above 0 and at most 100");
  require(arm >= 0 && arm <= 2, "arm must be between 0 and 2 meters");
  require(arm == 0 || path == "turn", "arm requires the path \"turn\"");
  require(things >= 0 && things <= 5, "things must be between 0 and 5");
  require(fov == 0 || (fov >= 10 && fov <= 150), "fov must be between 10 and 150 degrees");
  require(light > 0 && light <= 1, "light must be above 0 and at most 1");
  require(blur >= 0 && blur <= 500, "blur must be between 0 and 500 milliseconds");
  require(rolling_shutter >= 0 && rolling_shutter <= 500,
          "rolling_shutter must be between 0 and 500 milliseconds");
  require((distortion ? 1 : 0) + (k1 != 0 ? 1 : 0) + (fisheye ? 1 : 0) <= 1,
          "distortion, k1 and fisheye are different lenses: choose one");
  require(!fisheye || !stereo, "fisheye cannot be combined with stereo");
  require(k1 >= -1 && k1 <= 1, "k1 must be between -1 and 1");
  require(actors >= 0 && actors <= 20, "actors must be between 0 and 20");
  require(std::isfinite(noise) && noise >= 0 && noise <= 100,
          "noise must be between 0 and 100 gray levels");
  require(width >= 64 && width <= 4096, "width must be between 64 and 4096 pixels");
  require(height >= 48 && height <= 4096, "height must be between 48 and 4096 pixels");
  require(held >= 0 && held <= 0.5, "held must be between 0 and 0.5");
  const std::vector<std::string> imus = ImuNames();
  const bool simulated = std::find(imus.begin() + 1, imus.end(), imu) != imus.end();
  require(flight || simulated || imu == "off", "imu must be off, adis, phone or ideal");
  require(!flight || !simulated, "a flight has the readings of a file: imu=FILE");
  require(!flight || (imu_rate == 0 && !imu_offset),
          "the readings of a flight are as recorded: imu_rate and imu_offset are not for it");
  require(flight || imu_model.empty(), "imu_model is for flights");
  require(imu_rate == 0 || (imu_rate >= 10 && imu_rate <= 10000),
          "imu_rate must be between 10 and 10000 readings per second");
  require(!imu_offset || std::abs(*imu_offset) <= 1000,
          "imu_offset must be between -1000 and 1000 milliseconds");
  require(imu != "off" || (imu_rate == 0 && !imu_offset),
          "imu_rate and imu_offset need a sensor: imu=adis, phone or ideal");
  require(std::isfinite(fps) && fps >= 1 && fps <= 1000, "fps must be between 1 and 1000");
  // r (1 + k1 r²) grows up to r² = -1 / (3 k1) only, where it is 2/3 r: no ray comes further out.
  const double corner = std::hypot(width, height) / 2 / Focal();
  require(k1 >= 0 || corner < 2.0 / 3 / std::sqrt(-3 * k1),
          "k1 makes the distortion not invertible at the image corners: choose it closer to 0, or "
          "a smaller fov");
}

}  // namespace alidade
