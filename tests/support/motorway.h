// A straight motorway seen by a stereo pair in a car, rendered with exact poses: distant trees, a
// guard rail with identical posts, dashed lane markings. Few points are near, and those move fast.
#pragma once

#include <opencv2/imgproc.hpp>
#include <vector>

#include "alidade/synth/camera_path.h"
#include "alidade/synth/renderer.h"
#include "alidade/synth/sensor.h"
#include "support/texture.h"

namespace alidade {

struct MotorwaySettings {
  double step = 1.5;       // meters per frame
  int frames = 12;         // number of frames
  double noise = 3;        // gray levels, standard deviation
  double baseline = 0.54;  // meters, as in KITTI
  int width = 1240, height = 372;
  double focal = 707;  // pixels, as in KITTI
};

struct Motorway {
  struct Pair {
    double time;  // seconds
    cv::Mat left, right;
    Se3 T_world_camera;
  };
  Camera camera;
  std::vector<Pair> frames;
};

namespace motorway {

// x forward, y left, z up; meters. Visible from the side to which down × right points.
inline void AddRect(Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& right,
                    const Eigen::Vector3d& down, const cv::Mat& picture) {
  Rect rect;
  rect.origin = origin;
  rect.right = right;
  rect.down = down;
  rect.texture = static_cast<int>(scene.textures.size());
  scene.textures.emplace_back(picture);
  scene.rects.push_back(rect);
}

// `piece` repeated horizontally.
inline cv::Mat Repeated(const cv::Mat& piece, int times) {
  cv::Mat row;
  cv::repeat(piece, 1, times, row);
  return row;
}

inline Scene Build() {
  Scene scene;
  const double length = 160, ahead = length - 10;
  // Trees across the end, and along both sides at a larger distance.
  AddRect(scene, {ahead, 60, 22}, {0, -120, 0}, {0, 0, -22}, MakeTexture(1440, 264, 1));
  AddRect(scene, {-10, 28, 9}, {length, 0, 0}, {0, 0, -9}, MakeTexture(1920, 108, 2));
  AddRect(scene, {ahead, -28, 9}, {-length, 0, 0}, {0, 0, -9}, MakeTexture(1920, 108, 3));
  // Asphalt with 4 m dashes every 8 m: hardly any unique feature.
  cv::Mat road(1600, 160, CV_8UC1, cv::Scalar(105));
  AddNoise(road, 6, 4);
  for (int y = 0; y < road.rows; y += 80) {
    for (int x : {50, 110}) cv::rectangle(road, {x, y, 2, 40}, cv::Scalar(215), cv::FILLED);
  }
  AddRect(scene, {ahead, 8, 0}, {0, -16, 0}, {-length, 0, 0}, road);
  // A rail with identical posts every 2 m.
  cv::Mat piece(20, 50, CV_8UC1, cv::Scalar(150));
  cv::rectangle(piece, {0, 4, 50, 3}, cv::Scalar(200), cv::FILLED);
  cv::rectangle(piece, {20, 0, 5, 20}, cv::Scalar(60), cv::FILLED);
  AddRect(scene, {ahead, -7, 0.8}, {-length, 0, 0}, {0, 0, -0.8}, Repeated(piece, 80));
  AddRect(scene, {-10, 7, 0.8}, {length, 0, 0}, {0, 0, -0.8}, Repeated(piece, 80));
  return scene;
}

}  // namespace motorway

inline Motorway DriveMotorway(const MotorwaySettings& settings) {
  Motorway made;
  Camera& camera = made.camera;
  camera.width = settings.width;
  camera.height = settings.height;
  camera.fx = camera.fy = settings.focal;
  camera.cx = (settings.width - 1) / 2.0;
  camera.cy = (settings.height - 1) / 2.0;
  camera.baseline = settings.baseline;
  camera.fps = 10;
  const Scene scene = motorway::Build();
  const ViewRenderer renderer(scene, camera);
  for (int i = 0; i < settings.frames; ++i) {
    const Se3 pose{LookAlong(0, -0.02), {settings.step * i, -1.5, 1.65}};
    const auto look = [&](double aside, int channel) {
      Se3 eye = pose;
      eye.t = pose * Eigen::Vector3d(aside, 0, 0);
      Shutter shutter;
      shutter.T_world_camera = [eye](double) { return eye; };
      shutter.actors = [](double) { return std::vector<Quadric>{}; };
      return ExposeImage(renderer.Render(shutter).grey, 1, 0, settings.noise, {1, i, channel});
    };
    made.frames.push_back({0.1 * i, look(0, 0), look(settings.baseline, 1), pose});
  }
  return made;
}

}  // namespace alidade
