// Writes recordings of a few small images into a folder, for tests of the readers.
#pragma once

#include <opencv2/imgproc.hpp>
#include <string>

#include "alidade/base/random.h"
#include "alidade/io/files/image_file.h"
#include "support/temp_folder.h"

namespace alidade {

constexpr int kTinyWidth = 64, kTinyHeight = 48;

inline cv::Mat TinyImage(int seed, int width = kTinyWidth, int height = kTinyHeight) {
  Random random(static_cast<uint64_t>(seed) + 1);
  cv::Mat image(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<uchar>(y, x) = static_cast<uchar>(random.Below(256));
  }
  cv::GaussianBlur(image, image, {5, 5}, 1.5);
  return image;
}

// A depth image that identifies its frame: every value is 1000 + number.
inline cv::Mat TinyDepth(int number) {
  return cv::Mat(kTinyHeight, kTinyWidth, CV_16UC1, cv::Scalar(1000 + number));
}

// Stamp of frame i of a tiny TUM recording, which is also the name of its image.
inline std::string TinyStamp(int i) { return "10" + std::to_string(i) + ".500000"; }

struct TinyTum {
  int frames = 5;
  bool depth = true;
  bool camera = true;
};

inline void WriteTinyTum(const TempFolder& folder, const TinyTum& options = {}) {
  folder.Folder("rgb");
  folder.Folder("depth");
  std::string rgb = "# timestamp filename\n", depth = rgb;
  for (int i = 0; i < options.frames; ++i) {
    const std::string stamp = TinyStamp(i);
    WriteImage(folder / ("rgb/" + stamp + ".png"), TinyImage(i));
    rgb += stamp + " rgb/" + stamp + ".png\n";
    WriteImage(folder / ("depth/" + stamp + ".png"), TinyDepth(i));
    depth += stamp + " depth/" + stamp + ".png\n";
  }
  folder.Write("rgb.txt", rgb);
  if (options.depth) folder.Write("depth.txt", depth);
  if (options.camera) {
    folder.Write("camera.yaml",
                 "model: pinhole\nwidth: 64\nheight: 48\nfx: 60\nfy: 61\ncx: 31\ncy: 24\nfps: "
                 "30\ndepth_factor: 1000\n");
  }
}

}  // namespace alidade
