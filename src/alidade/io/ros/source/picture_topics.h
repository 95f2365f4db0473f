// The topics of a recording that pictures come in, each with what its first message says.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

struct PictureTopic {
  size_t topic = 0;  // of BagFile::Topics()
  std::string name;
  std::string base;  // without what image_transport adds: /compressed, /compressedDepth
  std::string encoding, frame_id;
  cv::Size size;
  bool compressed = false, depth = false;
  bool rectified = false;  // by its name: image_rect, image_rect_color, …
  std::string problem;     // not empty: not one of its first messages can be read, and why
  int64_t messages = 0;
};

// By name. Reads the first messages of each.
std::vector<PictureTopic> PictureTopicsOf(BagFile& bag);

// "/cam0/image_raw (mono8, 752x480, 2912 messages)".
std::string InWords(const PictureTopic& picture);

// Of /cam0/image_raw: /cam1/image_raw; left and right, infra1 and infra2 likewise. Empty when the
// name is not of a left camera.
std::string RightNameOf(const std::string& name);

// Its camera_info beside it (image_transport's rule), else one of the same frame when there is one
// alone; -1: none.
int InfoTopicOf(BagFile& bag, const PictureTopic& picture);

// The first calibration a topic tells; throws Error (input) when none of its messages can be read.
RosCameraInfo FirstInfo(BagFile& bag, size_t topic);

}  // namespace alidade
