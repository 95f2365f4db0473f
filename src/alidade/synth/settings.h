// What a rendered recording is asked to be.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace alidade {

// Names are those of the flags of `alidade synth` and of the options of a `synth:` source.
struct SynthSettings {
  std::string scene = "room";  // room, desk, corridor, wall or loop
  // Frames to play. A scene's path is walked at a natural speed and comes round once in
  // SceneFrames() frames at 30 per second; fewer play its beginning only, more go round again.
  int frames = 600;
  int actors = 0;                 // people walking about
  double noise = 4;               // standard deviation of the image noise, grey levels
  bool blur = false;              // shutter open for 20 ms: fast turns smear
  bool exposure = false;          // brightness and contrast drift slowly, as with auto-exposure
  bool distortion = false;        // lens with radial and tangential distortion
  bool rolling = false;           // rows are taken one after another over 16 ms
  bool stereo = false;            // a second, rectified camera 0.11 m to the right
  uint64_t seed = 1;              // of textures, clutter, shake, noise and actors
  int width = 640, height = 480;  // pixels
  double fps = 30;                // frames per second

  void Check() const;  // throws Error (usage) naming the field that cannot be
};

std::vector<std::string> SceneNames();
int SceneFrames(
    const std::string& scene);  // once round its path; scene must be one of SceneNames()

}  // namespace alidade
