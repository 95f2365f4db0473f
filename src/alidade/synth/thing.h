// Cups and cans moved by hand on a table.
#pragma once

#include <cstdint>
#include <vector>

#include "alidade/synth/scene.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

struct ThingLooks {
  double radius = 0.06, height = 0.14;          // meters
  int body = 0, lid = 0, skin = 0, sleeve = 0;  // texture indices
  int head = 0, shirt = -1;                     // texture indices; shirt -1: no sitting person
};

// Slides back and forth, rotates and is lifted slightly, with short pauses. A hand holds it; the
// arm comes from beyond the table's edge.
class Thing {
 public:
  Thing(const ThingLooks& looks, const TableTop& table, double phase);
  std::vector<Quadric> Parts(double time) const;
  Eigen::Vector3d Foot(double time) const;  // center of its bottom, meters

 private:
  double Done(double time) const;  // seconds of motion without the pauses

  ThingLooks looks_;
  TableTop table_;
  double phase_;
};

// Objects side by side along x, each in its own part of the table.
std::vector<Thing> PutThings(SceneBuilder& builder, const TableTop& table, int count,
                             uint64_t seed);

}  // namespace alidade
