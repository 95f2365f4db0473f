#include "alidade/synth/settings.h"

#include <cmath>

#include "alidade/base/error.h"

namespace alidade {
namespace {

struct NamedScene {
  const char* name;
  int frames;
};
constexpr NamedScene kScenes[] = {
    {"room", 600}, {"desk", 600}, {"corridor", 1000}, {"wall", 600}, {"loop", 2000}};

}  // namespace

std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

int SceneFrames(const std::string& name) {
  for (const NamedScene& scene : kScenes) {
    if (name == scene.name) return scene.frames;
  }
  std::string known;
  for (const NamedScene& scene : kScenes)
    known += std::string(known.empty() ? "" : ", ") + scene.name;
  ThrowUsage("synth: no scene is called \"" + name + "\"; there are " + known);
}

void SynthSettings::Check() const {
  SceneFrames(scene);
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("synth: ") + what);
  };
  require(frames >= 1 && frames <= 1000000, "frames must be between 1 and 1000000");
  require(actors >= 0 && actors <= 20, "actors must be between 0 and 20");
  require(std::isfinite(noise) && noise >= 0 && noise <= 100,
          "noise must be between 0 and 100 grey levels");
  require(width >= 64 && width <= 4096, "width must be between 64 and 4096 pixels");
  require(height >= 48 && height <= 4096, "height must be between 48 and 4096 pixels");
  require(std::isfinite(fps) && fps >= 1 && fps <= 1000, "fps must be between 1 and 1000");
}

}  // namespace alidade
