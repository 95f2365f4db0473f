// The messages of sensor_msgs that pictures come in, of ROS 1 and ROS 2 alike.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

struct MessageHeader {
  int64_t stamp = 0;  // nanoseconds; 0: not told
  std::string frame_id;
};

// Of sensor_msgs/Image or sensor_msgs/CompressedImage. `data` is the message's own.
struct RosPicture {
  MessageHeader header;
  bool compressed = false;
  std::string encoding;  // "bgr8"; of compressed ones "rgb8; jpeg compressed bgr8" and the like
  uint32_t width = 0, height = 0,
           step = 0;  // pixels, bytes from row to row; not of compressed ones
  bool big_endian = false;
  std::string_view data;
};

// sensor_msgs/CameraInfo, names as there.
struct RosCameraInfo {
  MessageHeader header;
  uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{}, R{};  // row by row
  std::array<double, 12> P{};
  uint32_t binning_x = 0, binning_y = 0;
  uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;
};

// They throw Error (input) saying what is wrong with the message.
MessageHeader ParseRosHeader(std::string_view message, Serialization serialization);
RosPicture ParseRosPicture(std::string_view message, Serialization serialization, bool compressed);
RosCameraInfo ParseRosCameraInfo(std::string_view message, Serialization serialization);

}  // namespace alidade
