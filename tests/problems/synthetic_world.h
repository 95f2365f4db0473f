// Landmarks with descriptors, and the frames a camera has of them along a path: for tests and
// benchmarks of what works on keypoints and never sees an image.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/features/frame.h"

namespace alidade {

struct SyntheticWorldSettings {
  int points = 600;
  int cameras = 8;
  double step = 0.15;   // metres from one camera to the next, sideways
  double turn = 0.01;   // radians from one camera to the next, to the side
  double noise_px = 0;  // standard deviation of a keypoint on level 0; grows with the level's scale
  int flipped_bits = 0;  // of 256, in each view of a descriptor
  int clutter = 0;       // keypoints per frame that show no point
  bool depth = false;    // keypoints come with exact depth
  double ring = 0;  // metres: the path is a circle of this radius, looked out from, with points
                    // all around; 0: straight ahead, with a wall of points beside it
  int lap = 30;     // cameras once around it
  uint64_t seed = 1;
};

// What one camera sees.
struct SyntheticView {
  Se3 T_camera_world;
  std::shared_ptr<const Frame> frame;
  std::vector<int> points;  // index of the point each keypoint shows; -1: clutter
};

struct SyntheticWorld {
  Camera camera;
  std::vector<Eigen::Vector3d> points;  // the world is the first camera
  std::vector<Descriptor> descriptors;  // of the points
  std::vector<SyntheticView> views;
};

inline Descriptor RandomDescriptor(Random& random) {
  Descriptor descriptor;
  for (uint64_t& word : descriptor.words) {
    word = random.Next();
    word = word << 32 | random.Next();
  }
  return descriptor;
}

inline Descriptor WithFlippedBits(Descriptor descriptor, int count, Random& random) {
  for (int bit : random.Sample(count, 256)) descriptor.words[bit / 64] ^= uint64_t{1} << (bit % 64);
  return descriptor;
}

// A point of a fixed size is found on a coarser pyramid level when it is nearer; -1: on none.
inline int LevelSeenOn(double size, double distance) {
  const int level =
      static_cast<int>(std::lround(std::log(size / distance) / std::log(kPyramidScale)));
  return level >= 0 && level < kPyramidLevels ? level : -1;
}

class SyntheticWorldMaker {
 public:
  explicit SyntheticWorldMaker(const SyntheticWorldSettings& settings)
      : settings_(settings), random_(settings.seed) {
    Camera& camera = world_.camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = 520;
    camera.fy = 522;
    camera.cx = 318;
    camera.cy = 243;
    if (settings.depth) camera.depth_factor = 5000;
    settings.ring > 0 ? Surround() : Line();
  }

  // Adds the view from a pose; frames are numbered in order, 30 a second.
  const SyntheticView& Look(const Se3& T_camera_world) {
    std::vector<std::pair<Keypoint, int>> seen;
    for (size_t i = 0; i < world_.points.size(); ++i) {
      const Eigen::Vector3d p = T_camera_world * world_.points[i];
      const int level = p.z() > 0.1 ? LevelSeenOn(sizes_[i], p.norm()) : -1;
      if (level < 0) continue;
      const double sigma = settings_.noise_px * ScaleOfLevel(level);
      Eigen::Vector2d pixel = world_.camera.Project(p);
      pixel.x() += sigma * random_.Gaussian();
      pixel.y() += sigma * random_.Gaussian();
      Keypoint keypoint = At(pixel, level, angles_[i]);
      if (!Inside(keypoint)) continue;
      if (settings_.depth) {
        keypoint.depth = static_cast<float>(p.z());
        keypoint.right_x = static_cast<float>(pixel.x() - world_.camera.bf() / p.z());
      }
      seen.push_back({keypoint, static_cast<int>(i)});
    }
    for (int i = 0; i < settings_.clutter; ++i) {
      const double x = random_.Uniform(kBorder, world_.camera.width - kBorder);
      const double y = random_.Uniform(kBorder, world_.camera.height - kBorder);
      const int level = static_cast<int>(random_.Below(kPyramidLevels));
      seen.push_back({At({x, y}, level, random_.Uniform(-3, 3)), -1});
    }
    std::sort(seen.begin(), seen.end(),
              [](const auto& a, const auto& b) {  // as the extractor has them
                if (a.first.level != b.first.level) return a.first.level < b.first.level;
                return a.first.y != b.first.y ? a.first.y < b.first.y : a.first.x < b.first.x;
              });
    SyntheticView view;
    view.T_camera_world = T_camera_world;
    auto frame = std::make_shared<Frame>();
    frame->number = static_cast<int>(world_.views.size());
    frame->time = frame->number / 30.0;
    for (const auto& [keypoint, point] : seen) {
      frame->keypoints.push_back(keypoint);
      frame->descriptors.push_back(
          point < 0 ? RandomDescriptor(random_)
                    : WithFlippedBits(world_.descriptors[point], settings_.flipped_bits, random_));
      view.points.push_back(point);
    }
    frame->grid = KeypointGrid(frame->keypoints, world_.camera.width, world_.camera.height);
    view.frame = std::move(frame);
    world_.views.push_back(std::move(view));
    return world_.views.back();
  }

  SyntheticWorld Take() { return std::move(world_); }

 private:
  static constexpr double kBorder = 16;  // pixels without keypoints

  // Spread over all that the path looks at.
  void Line() {
    const double way = settings_.step * std::max(0, settings_.cameras - 1);
    for (int i = 0; i < settings_.points; ++i) {
      const double z = random_.Uniform(2.5, 7), x = random_.Uniform(-0.6, 0.6) * z,
                   y = random_.Uniform(-0.45, 0.45) * z;
      AddPoint({x + way * random_.Uniform(), y, z}, z);
    }
  }

  void Surround() {
    for (int i = 0; i < settings_.points; ++i) {
      const double z = random_.Uniform(2.5, 7), y = random_.Uniform(-0.45, 0.45) * z,
                   angle = random_.Uniform(-std::numbers::pi, std::numbers::pi);
      const double radius = settings_.ring + z;
      AddPoint({radius * std::sin(angle), y, radius * std::cos(angle) - settings_.ring}, z);
    }
  }

  // `distance`: from which it is looked at, metres.
  void AddPoint(const Eigen::Vector3d& p, double distance) {
    world_.points.push_back(p);
    world_.descriptors.push_back(RandomDescriptor(random_));
    sizes_.push_back(distance * std::pow(kPyramidScale, random_.Uniform(0.5, 5.5)));
    angles_.push_back(random_.Uniform(-std::numbers::pi, std::numbers::pi));
  }

  static Keypoint At(const Eigen::Vector2d& pixel, int level, double angle) {
    Keypoint keypoint;
    keypoint.x = keypoint.raw_x = static_cast<float>(pixel.x());
    keypoint.y = keypoint.raw_y = static_cast<float>(pixel.y());
    keypoint.level = level;
    keypoint.angle = static_cast<float>(angle);
    keypoint.response = 20;
    return keypoint;
  }
  bool Inside(const Keypoint& k) const {
    return k.x >= kBorder && k.y >= kBorder && k.x < world_.camera.width - kBorder &&
           k.y < world_.camera.height - kBorder;
  }

  SyntheticWorldSettings settings_;
  Random random_;
  SyntheticWorld world_;
  std::vector<double> sizes_;   // distance at which a point is seen on level 0, metres
  std::vector<double> angles_;  // orientation of the patch, radians
};

// Pose of camera `i` on the path: to the right in steps, or around the ring, with a little of
// everything else.
inline Se3 PoseOnPath(const SyntheticWorldSettings& settings, double i) {
  if (settings.ring > 0) {
    const double angle = 2 * std::numbers::pi * i / settings.lap;
    const Eigen::Vector3d centre(settings.ring * std::sin(angle), 0.04 * std::sin(angle),
                                 settings.ring * (std::cos(angle) - 1));
    return Se3{ExpSo3({0, angle, 0}), centre}.Inverse();
  }
  const Eigen::Vector3d centre(settings.step * i, 0.04 * std::sin(1.3 * i),
                               0.05 * std::sin(0.7 * i));
  const Eigen::Matrix3d R =
      ExpSo3({0.01 * std::sin(0.9 * i), -settings.turn * i, 0.02 * std::sin(0.5 * i)});
  return Se3{R.transpose(), centre}.Inverse();
}

// The pose of the same camera when the world is seen from another: p_other = T_other_world * p.
inline Se3 InOtherWorld(const Se3& T_camera_world, const Sim3& T_other_world) {
  const Sim3 T = Sim3{1, T_camera_world.R, T_camera_world.t} * T_other_world.Inverse();
  return {T.R, T.t / T.s};  // in the other's units of length
}

inline SyntheticWorld MakeSyntheticWorld(const SyntheticWorldSettings& settings = {}) {
  SyntheticWorldMaker maker(settings);
  for (int i = 0; i < settings.cameras; ++i) maker.Look(PoseOnPath(settings, i));
  return maker.Take();
}

}  // namespace alidade
