// A sparse model in COLMAP's formats (Schönberger & Frahm 2016; colmap.github.io/format.html).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/geometry/raw_camera.h"
#include "alidade/geometry/se3.h"

namespace ALIDADE_API alidade {

// A sparse model with one camera. Pixels refer to the image as recorded, with 0, 0 at the center of
// the top-left pixel as everywhere in Alidade; encoding adds COLMAP's half pixel.
struct ColmapModel {
  static constexpr int kNoPoint = -1;

  struct Keypoint {
    Eigen::Vector2d pixel;
    int point = kNoPoint;  // index in `points`
  };
  struct Image {
    std::string name;  // without whitespace
    Se3 T_camera_world;
    std::vector<Keypoint> keypoints;
  };
  struct Seen {
    int image = 0;     // index in `images`
    int keypoint = 0;  // index in that image's `keypoints`
  };
  struct Point {
    Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
    std::array<uint8_t, 3> color = {128, 128, 128};  // red green blue; gray when unknown
    // Mean distance to its keypoints, pixels of the recorded image; -1: unknown.
    double error = -1;
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

// cameras.txt with one camera; a fisheye is OPENCV_FISHEYE.
std::string EncodeColmapCamera(const RawCamera& camera);

// Encode the files cameras, images and points3D; ids are indices plus one. The camera model is
// PINHOLE without distortion, OPENCV when k3 is 0, otherwise FULL_OPENCV. Throw Error (usage) when
// an index is out of range or an image name is empty or contains whitespace.
std::vector<ColmapFile> EncodeColmapText(const ColmapModel& model);    // *.txt
std::vector<ColmapFile> EncodeColmapBinary(const ColmapModel& model);  // *.bin

}  // namespace alidade
