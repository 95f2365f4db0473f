// The image topics of a recording, described by their first messages.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

struct PictureTopic {
  size_t topic = 0;  // index in BagFile::Topics()
  std::string name;
  std::string base;  // name without image_transport's suffixes /compressed and /compressedDepth
  std::string encoding, frame_id;
  cv::Size size;
  bool compressed = false, depth = false;
  bool video = false;      // the messages are frames of one video (TopicVideo)
  bool rectified = false;  // by its name: image_rect, image_rect_color, …
  std::string problem;     // why none of the first messages can be read; empty: no problem
  int64_t messages = 0;
};

// All image topics, sorted by name. Reads the first messages of each.
std::vector<PictureTopic> PictureTopicsOf(BagFile& bag);

// A description for users: "/cam0/image_raw (mono8, 752x480, 2912 messages)".
std::string InWords(const PictureTopic& picture);

// Name of the right image for a left one: /cam1/image_raw for /cam0/image_raw; likewise for left
// and right, infra1 and infra2. Empty when the name is not that of a left image.
std::string RightNameOf(const std::string& name);

// Index of the CameraInfo topic: camera_info beside the image topic (image_transport's rule), else
// the only one with the same frame_id and size; -1: none.
int InfoTopicOf(BagFile& bag, const PictureTopic& picture);

// The first readable calibration of a topic. Throws Error (input) when none of the first messages
// can be read.
RosCameraInfo FirstInfo(BagFile& bag, size_t topic);

}  // namespace alidade
