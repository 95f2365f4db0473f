// A sparse model in COLMAP's formats (Schönberger & Frahm 2016; colmap.github.io/format.html).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// A model of one camera as plain values. Pixels are those of the image as taken, the centre of the
// top-left one at 0, 0 as everywhere in Alidade: COLMAP's half pixel is added when it is written.
struct ColmapModel {
  static constexpr int kNoPoint = -1;

  struct Keypoint {
    Eigen::Vector2d pixel;
    int point = kNoPoint;  // index in `points`
  };
  struct Image {
    std::string name;  // no blanks
    Se3 T_camera_world;
    std::vector<Keypoint> keypoints;
  };
  struct Seen {
    int image = 0;     // index in `images`
    int keypoint = 0;  // index in that image
  };
  struct Point {
    Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
    std::array<uint8_t, 3> color = {128, 128, 128};  // red green blue; grey when unknown
    double error =
        -1;  // mean distance to its keypoints, pixels of the image as taken; -1 = unknown
    std::vector<Seen> track;
  };

  Camera camera;
  std::vector<Image> images;
  std::vector<Point> points;
};

struct ColmapFile {
  std::string name;
  std::string bytes;
};

// cameras, images, points3D; ids are indices plus one. The camera is a PINHOLE when it has no
// distortion, OPENCV when k3 is 0, FULL_OPENCV else. Throws Error (usage) when an index leads
// nowhere.
std::vector<ColmapFile> EncodeColmapText(const ColmapModel& model);    // *.txt
std::vector<ColmapFile> EncodeColmapBinary(const ColmapModel& model);  // *.bin

}  // namespace alidade
