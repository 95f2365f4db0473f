// Walking people composed of quadrics.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "alidade/synth/camera_path.h"
#include "alidade/synth/scene.h"
#include "alidade/synth/scenes/scenes.h"

namespace alidade {

struct ActorLooks {
  double height = 1.75;                                                     // meters
  double girth = 1;                                                         // factor
  int head = 0, shirt = 0, sleeves = 0, trousers = 0, shoes = 0, skin = 0;  // texture indices
};

class Actor {
 public:
  Actor(ActorLooks looks, Walk walk, double start, double speed, double wander_phase);
  Eigen::Vector2d Position(double time) const;  // on the floor, meters; time in seconds
  std::vector<Quadric> Body(double time) const;

 private:
  double Along(double time) const;  // meters walked since the first corner of the walk
  Eigen::Vector2d At(double along) const;

  ActorLooks looks_;
  Walk walk_;
  std::vector<double> until_;  // path length at each corner, meters
  double start_, speed_, wander_phase_;
};

ActorLooks DressActor(SceneBuilder& builder, Random& random);

// `count` people on the walks, placed so that they keep away from the camera for `seconds`.
std::vector<Actor> CastActors(const std::vector<ActorLooks>& looks, const std::vector<Walk>& walks,
                              const CameraPath& path, double seconds, uint64_t seed);

}  // namespace alidade
