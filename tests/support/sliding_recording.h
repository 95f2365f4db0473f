// A small recording that can be tracked fast: the camera faces a textured wall and moves along it.
#pragma once

#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

#include "alidade/base/random.h"
#include "alidade/io/files/image_file.h"
#include "support/temp_folder.h"

namespace alidade {

struct SlidingRecording {
  int frames = 12;
  int width = 320, height = 240;
  double focal = 250;                                     // pixels
  double depth = 2;                                       // distance to the wall, meters
  int step = 3;                                           // motion of the image per frame, pixels
  double metres() const { return step * depth / focal; }  // motion of the camera per frame along x
};

inline std::string SlidingStamp(int i) {
  char stamp[32];
  std::snprintf(stamp, sizeof(stamp), "%.6f", 100 + i / 30.0);
  return stamp;
}

inline std::string SlidingImage(int i) { return "rgb/" + SlidingStamp(i) + ".png"; }

// Writes it as a TUM RGB-D folder.
inline void WriteSlidingTum(const TempFolder& folder, const SlidingRecording& options = {}) {
  Random random(1);
  cv::Mat wall(options.height, options.width + options.step * options.frames, CV_8UC1);
  for (int y = 0; y < wall.rows; y += 6) {
    for (int x = 0; x < wall.cols; x += 6) {
      wall(cv::Rect(x, y, 6, 6) & cv::Rect(0, 0, wall.cols, wall.rows)) =
          static_cast<int>(40 + random.Below(176));
    }
  }
  cv::GaussianBlur(wall, wall, {3, 3}, 0.7);
  folder.Folder("rgb");
  folder.Folder("depth");
  std::string rgb, depth;
  for (int i = 0; i < options.frames; ++i) {
    const std::string stamp = SlidingStamp(i), depth_image = "depth/" + stamp + ".png";
    const cv::Rect view(i * options.step, 0, options.width, options.height);
    WriteImage(folder / SlidingImage(i), wall(view).clone());
    WriteImage(folder / depth_image,
               cv::Mat(options.height, options.width, CV_16UC1, cv::Scalar(options.depth * 5000)));
    rgb += stamp + " " + SlidingImage(i) + "\n";
    depth += stamp + " " + depth_image + "\n";
  }
  folder.Write("rgb.txt", rgb);
  folder.Write("depth.txt", depth);
  folder.Write(
      "camera.yaml",
      "model: pinhole\nwidth: " + std::to_string(options.width) +
          "\nheight: " + std::to_string(options.height) + "\nfx: " + std::to_string(options.focal) +
          "\nfy: " + std::to_string(options.focal) + "\ncx: " + std::to_string(options.width / 2) +
          "\ncy: " + std::to_string(options.height / 2) + "\nfps: 30\ndepth_factor: 5000\n");
}

}  // namespace alidade
