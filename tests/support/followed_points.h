// Points tracked by a moving camera, some of them moving together: ideal optical flow with ground
// truth.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/dynamics/cells.h"
#include "alidade/dynamics/flow_tracks.h"
#include "alidade/dynamics/history.h"
#include "support/vga_camera.h"

namespace alidade {

struct FollowedSettings {
  int frames = 16;
  int standing = 300;
  double noise_px = 0.2;
  bool depth = false;      // earlier frames have depth per cell
  bool scattered = false;  // static points are anywhere from 2.5 m to 5 m, instead of on walls
  std::function<Se3(int frame)> T_camera_world = [](int frame) {
    return Se3{Eigen::Matrix3d::Identity(), {-0.01 * frame, 0.002 * frame, 0}};
  };
  // Position of a group of moving points (a board of 0.5 m), meters; all other points are static.
  int moving = 40;
  std::function<Eigen::Vector3d(int frame)> board = [](int frame) {
    return Eigen::Vector3d(-0.3 + 0.02 * frame, 0, 2);
  };
};

struct FollowedPoints {
  Camera camera;
  std::vector<FlowTrack> tracks;
  std::vector<uint8_t> moves;  // per track
  History history;             // all frames except the last
  Se3 T_camera_world;          // of the last frame
  std::vector<float> depth;    // per cell of the last frame; empty without depth
};

// Static points are on two walls at 2.5 m and 4 m, to the left and to the right.
inline FollowedPoints FollowPoints(const FollowedSettings& settings) {
  FollowedPoints made;
  made.camera = MakeVgaCamera();
  const Cells cells(made.camera);
  Random random(21);
  const auto wall_at = [](double x) { return x < 0 ? 2.5 : 4.0; };
  const auto project = [&](const Eigen::Vector3d& p, int frame) {
    return made.camera.Project(settings.T_camera_world(frame) * p);
  };
  for (int i = 0; i < settings.standing + settings.moving; ++i) {
    const bool moves = i >= settings.standing;
    Eigen::Vector3d p(random.Uniform(-1.6, 1.6), random.Uniform(-1.1, 1.1), 0);
    p.z() = settings.scattered ? random.Uniform(2.5, 5) : wall_at(p.x());
    if (moves) p = {random.Uniform(-0.2, 0.2), random.Uniform(-0.25, 0.25), 0};
    FlowTrack track;
    track.id = static_cast<uint32_t>(i);
    bool seen = true;
    for (int frame = 0; frame < settings.frames; ++frame) {
      const Eigen::Vector2d pixel =
          project(moves ? p + settings.board(frame) : p, frame) +
          settings.noise_px * Eigen::Vector2d(random.Gaussian(), random.Gaussian());
      seen &= pixel.x() > 0 && pixel.y() > 0 && pixel.x() < 639 && pixel.y() < 479;
      track.path.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
    if (!seen) continue;
    if (!moves) {  // skip points hidden by the board, or too near to it to be distinguished
      bool hidden = false;
      for (int frame = 0; frame < settings.frames; ++frame) {
        const Eigen::Vector2d centre = project(settings.board(frame), frame);
        const double reach = 0.35 * 525 / settings.board(frame).z() + 30;
        const cv::Point2f at = track.path[frame];
        hidden |= std::abs(at.x - centre.x()) < reach && std::abs(at.y - centre.y()) < reach;
      }
      if (hidden) continue;
    }
    made.tracks.push_back(std::move(track));
    made.moves.push_back(moves);
  }
  const auto depth_of = [&](int frame) {
    std::vector<float> depth(cells.count(), 0);
    const Se3 T_world_camera = settings.T_camera_world(frame).Inverse();
    for (int i = 0; i < cells.count(); ++i) {
      const Eigen::Vector3d direction = T_world_camera.R * cells.Ray(i);
      const auto to = [&](double z) { return (z - T_world_camera.t.z()) / direction.z(); };
      const Eigen::Vector3d board = settings.board(frame);
      const Eigen::Vector3d on_board = T_world_camera.t + to(board.z()) * direction;
      const bool hit = settings.moving > 0 && std::abs(on_board.x() - board.x()) < 0.25 &&
                       std::abs(on_board.y() - board.y()) < 0.3;
      const Eigen::Vector3d on_near = T_world_camera.t + to(2.5) * direction;
      depth[i] = static_cast<float>(hit ? to(board.z()) : to(on_near.x() < 0 ? 2.5 : 4.0));
    }
    return depth;
  };
  for (int frame = 0; frame + 1 < settings.frames; ++frame) {
    auto view = std::make_shared<PastView>();
    view->number = frame;
    view->T_camera_world = settings.T_camera_world(frame);
    view->static_log_odds.assign(cells.count(), 0);
    if (settings.depth) view->depth = depth_of(frame);
    made.history.Add(view);
  }
  made.T_camera_world = settings.T_camera_world(settings.frames - 1);
  if (settings.depth) made.depth = depth_of(settings.frames - 1);
  return made;
}

// Share of the moving (or static) tracks that have this vote.
inline double ShareOf(const FollowedPoints& made, const std::vector<int8_t>& votes, bool moves,
                      int vote) {
  int all = 0, found = 0;
  for (size_t i = 0; i < votes.size(); ++i) {
    if ((made.moves[i] != 0) != moves) continue;
    ++all;
    found += votes[i] == vote;
  }
  return all > 0 ? static_cast<double>(found) / all : std::nan("");
}

}  // namespace alidade
