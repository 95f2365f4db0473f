// Textured planes seen by a moving camera, with exact depth, for tests of semi-dense algorithms:
// the images, and a matching map.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "alidade/map/map_store.h"
#include "support/texture.h"

namespace alidade {

struct DenseView {
  Se3 T_camera_world;
  cv::Mat image;  // CV_8U
  cv::Mat depth;  // CV_32F, exact, along z
};

struct DenseWorldSettings {
  double noise = 3;             // standard deviation, gray levels
  double gain = 1, offset = 0;  // exposure of this image
  uint64_t noise_seed = 1;
};

// A wall at an angle, and a panel in front of a part of it at a distance of 1.2 m.
class DenseWorld {
 public:
  explicit DenseWorld(uint64_t seed = 5) {
    camera_.width = 320;
    camera_.height = 240;
    camera_.fx = camera_.fy = 260;
    camera_.cx = 160.5;
    camera_.cy = 118;
    wall_ = MakeTexture(1200, 800, seed);
    panel_ = MakeTexture(300, 300, seed + 1);
  }
  const Camera& camera() const { return camera_; }

  DenseView Look(const Se3& T_camera_world, const DenseWorldSettings& settings = {}) const {
    DenseView view{T_camera_world, cv::Mat(camera_.height, camera_.width, CV_8U),
                   cv::Mat(camera_.height, camera_.width, CV_32F)};
    const Se3 T_world_camera = T_camera_world.Inverse();
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        const Eigen::Vector3d direction =
            T_world_camera.R * camera_.Unproject(Eigen::Vector2d(x, y));
        const auto [depth, value] = Hit(T_world_camera.t, direction);
        view.depth.at<float>(y, x) = static_cast<float>(depth);
        view.image.at<uint8_t>(y, x) =
            cv::saturate_cast<uint8_t>(settings.gain * value + settings.offset);
      }
    }
    AddNoise(view.image, settings.noise, settings.noise_seed);
    return view;
  }

 private:
  static double Texel(const cv::Mat& texture, double u, double v) {  // bilinear, periodic
    const auto at = [&](int x, int y) {
      const int w = texture.cols, h = texture.rows;
      return static_cast<double>(texture.at<uint8_t>((y % h + h) % h, (x % w + w) % w));
    };
    const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
    const double a = u - x, b = v - y;
    return (1 - b) * ((1 - a) * at(x, y) + a * at(x + 1, y)) +
           b * ((1 - a) * at(x, y + 1) + a * at(x + 1, y + 1));
  }

  // Depth along the ray in lengths of `direction` (whose z in the camera is 1), and gray level.
  std::pair<double, double> Hit(const Eigen::Vector3d& from,
                                const Eigen::Vector3d& direction) const {
    constexpr double kTexels = 85;  // per meter: about one pixel per texel
    const double panel = (1.8 - from.z()) / direction.z();
    const Eigen::Vector3d on_panel = from + panel * direction;
    if (std::abs(on_panel.x() + 0.2) < 0.35 && std::abs(on_panel.y() - 0.1) < 0.3)
      return {panel, Texel(panel_, 1.6 * kTexels * on_panel.x(), 1.6 * kTexels * on_panel.y())};
    const Eigen::Vector3d normal(-0.25, 0, 1);  // of the wall: z = 3 + 0.25 x
    const double wall = (3 - normal.dot(from)) / normal.dot(direction);
    const Eigen::Vector3d on_wall = from + wall * direction;
    return {wall, Texel(wall_, kTexels * on_wall.x(), kTexels * on_wall.y())};
  }

  Camera camera_;
  cv::Mat wall_, panel_;
};

// A camera at `centre`, rotated by `turn` about the vertical (radians).
inline Se3 CameraAt(const Eigen::Vector3d& centre, double turn = 0) {
  Vector6d xi = Vector6d::Zero();
  xi[4] = turn;
  const Eigen::Matrix3d R = Se3::Exp(xi).R;
  return {R, -R * centre};
}

// Camera positions left and right, up and down in front of the wall, `step` meters apart.
inline std::vector<Se3> WayBeforeTheWall(int cameras, double step) {
  std::vector<Se3> way;
  for (int i = 0; i < cameras; ++i) {
    const double x = step * (i - (cameras - 1) / 2.0);
    way.push_back(CameraAt({x, 0.4 * step * (i % 3), 0.3 * step * (i % 2)}, 0.004 * i));
  }
  return way;
}

// Adds the views as keyframes of one map, with exact landmarks on a grid of each view, observed by
// all views that see them.
inline std::vector<KeyFrameId> EnterViews(const std::vector<DenseView>& views, const Camera& camera,
                                          MapStore& store) {
  std::vector<std::shared_ptr<Frame>> frames;
  for (size_t v = 0; v < views.size(); ++v) {
    frames.push_back(std::make_shared<Frame>());
    frames.back()->number = static_cast<int>(v);
    frames.back()->time = static_cast<double>(v);
  }
  std::vector<std::pair<Eigen::Vector3d, std::vector<std::pair<size_t, int>>>> points;
  for (const DenseView& view : views) {
    for (int y = 12; y < camera.height; y += 24) {
      for (int x = 12; x < camera.width; x += 24) {
        const Eigen::Vector3d p =
            view.T_camera_world.Inverse() *
            camera.Unproject(Eigen::Vector2d(x, y), view.depth.at<float>(y, x));
        std::vector<std::pair<size_t, int>> seen;
        for (size_t v = 0; v < views.size(); ++v) {
          const Eigen::Vector3d q = views[v].T_camera_world * p;
          const Eigen::Vector2d pixel = camera.Project(q);
          const int u = static_cast<int>(std::lround(pixel.x()));
          const int w = static_cast<int>(std::lround(pixel.y()));
          if (q.z() <= 0 || u < 0 || w < 0 || u >= camera.width || w >= camera.height) continue;
          if (std::abs(views[v].depth.at<float>(w, u) - q.z()) > 0.02 * q.z()) continue;
          Keypoint keypoint;
          keypoint.x = keypoint.raw_x = static_cast<float>(pixel.x());
          keypoint.y = keypoint.raw_y = static_cast<float>(pixel.y());
          seen.push_back({v, static_cast<int>(frames[v]->keypoints.size())});
          frames[v]->keypoints.push_back(keypoint);
          frames[v]->descriptors.emplace_back();
        }
        if (seen.size() >= 2) points.push_back({p, std::move(seen)});
      }
    }
  }
  std::vector<KeyFrameId> ids;
  store.Commit([&](MapCommit& commit) {
    for (size_t v = 0; v < views.size(); ++v) {
      KeyFrame keyframe;
      keyframe.frame = frames[v];
      keyframe.T_camera_world = views[v].T_camera_world;
      if (v > 0) keyframe.parent = ids.back();
      ids.push_back(commit.Add(std::move(keyframe)));
    }
    for (const auto& [p, seen] : points) {
      Landmark landmark;
      landmark.p_world = p;
      for (const auto& [v, keypoint] : seen) landmark.observations.push_back({ids[v], keypoint});
      landmark.reference = landmark.born = ids[seen.front().first];
      commit.RefreshLandmark(commit.Add(std::move(landmark)));
    }
    for (KeyFrameId id : ids) commit.RefreshCovisibility(id);
  });
  return ids;
}

}  // namespace alidade
