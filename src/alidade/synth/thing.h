// Cups and tins that somebody moves about on a table.
#pragma once

#include <cstdint>
#include <vector>

#include "alidade/synth/scene.h"
#include "alidade/synth/scenes.h"

namespace alidade {

struct ThingLooks {
  double radius = 0.06, height = 0.14;          // metres
  int body = 0, lid = 0, skin = 0, sleeve = 0;  // textures
  int head = 0, shirt = -1;                     // -1: nobody sits there
};

// Slid to and fro, turned and lifted a little, now and then left alone for a moment; a hand holds
// it, whose arm comes from beyond the table's edge.
class Thing {
 public:
  Thing(const ThingLooks& looks, const TableTop& table, double phase);
  std::vector<Quadric> Parts(double time) const;
  Eigen::Vector3d Foot(double time) const;  // middle of its bottom, metres

 private:
  double Done(double time) const;  // seconds of motion, without the pauses

  ThingLooks looks_;
  TableTop table_;
  double phase_;
};

// Side by side along x, each in its own part of the table.
std::vector<Thing> PutThings(SceneBuilder& builder, const TableTop& table, int count,
                             uint64_t seed);

}  // namespace alidade
