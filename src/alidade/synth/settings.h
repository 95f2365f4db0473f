// What a rendered recording is asked to be.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace alidade {

// The scene that is built around a given path (flight.h).
inline constexpr char kFlightScene[] = "flight";

// Names are those of the flags of `alidade synth` and of the options of a `synth:` source.
struct SynthSettings {
  std::string scene = "room";  // one of SceneNames(), or kFlightScene
  // Frames to play. A scene's path is walked at a natural speed and comes round once in
  // SceneFrames() frames at 30 per second; fewer play its beginning only, more go round again.
  int frames = 600;
  // The way the camera takes: "walk", the scene's own; "turn", it turns on the spot, about its own
  // centre; "turn-walk", it does so for 4 s and then walks; "still", it stands, as on a tripod.
  // Of a flight: the file with its poses.
  std::string path = "walk";
  double speed = 1;  // times that of the scene's own
  double arm = 0;    // metres from the axis of a turn to the camera, which looks away
  int actors = 0;    // people walking about
  int things = 0;    // cups and tins moved about by hand, where there is a table
  double noise = 4;  // standard deviation of the image noise, grey levels
  // Share of daylight. The exposure makes up for it up to 4 times, below a quarter pictures are
  // dark; what light is left is uneven (shot noise): against what is seen the noise is
  // 1 / sqrt(light) of what it is by day.
  double light = 1;
  double blur = 0;                // milliseconds the shutter is open: fast turns smear
  bool exposure = false;          // brightness and contrast drift slowly, as with auto-exposure
  bool distortion = false;        // lens with radial and tangential distortion
  double k1 = 0;                  // lens with radial distortion alone: Brown's k1
  bool fisheye = false;           // equidistant lens: as many pixels for each degree
  double rolling_shutter = 0;     // milliseconds from the first row to the last
  bool stereo = false;            // a second, rectified camera 0.11 m to the right
  uint64_t seed = 1;              // of textures, clutter, shake, noise and actors
  int width = 640, height = 480;  // pixels
  double fov = 0;                 // horizontal field of view, degrees; 0: 62.7, as of a Kinect
  double fps = 30;                // frames per second
  double held = 0;                // share of frames that come .2 to 1 s late: a busy phone
  bool calibrated = true;         // false: sources assume a camera, as if nothing were known of it

  // The inertial sensor: "off"; "ideal", without errors; "adis", that of EuRoC's rig, everything
  // known of it; "phone", nothing known of it. Of a flight: the file with its readings.
  std::string imu = "off";
  double imu_rate = 0;  // readings per second; 0: of a phone 60, as of its browser, else 200
  // An image taken at t was taken at t + imu_offset on the clock of the readings, milliseconds; not
  // set: 0, of a phone -30 to 30 by seed.
  std::optional<double> imu_offset;
  std::string imu_model;  // of a flight: the file with the sensor's pose; empty: EuRoC's

  // What --blur, --rolling and switches of those names stand for: ms of a shutter indoors, of a
  // phone's sensor.
  static constexpr double kUsualBlur = 20, kUsualRolling = 16;

  double Focal() const;    // focal length, pixels; of a fisheye: pixels per radian
  double ImuRate() const;  // readings per second; 0: no sensor
  void Check() const;      // throws Error (usage) naming the field that cannot be
  bool operator==(const SynthSettings&) const = default;
};

std::vector<std::string> SceneNames();
std::vector<std::string> PathNames();
std::vector<std::string> ImuNames();  // "off" first
// Frames once round the path of a scene; 0 of kFlightScene: all of its path.
int SceneFrames(const std::string& scene);
// The settings to start from: the scene's frames; of a flight the camera of EuRoC's rig.
SynthSettings SynthDefaults(const std::string& scene);

}  // namespace alidade
