// The messages of sensor_msgs that contain images and calibrations, for ROS 1 and ROS 2.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

struct MessageHeader {
  int64_t stamp = 0;  // nanoseconds; 0: not set
  std::string frame_id;
};

// sensor_msgs/Image or sensor_msgs/CompressedImage. `data` refers to the message's bytes.
struct RosPicture {
  MessageHeader header;
  bool compressed = false;
  std::string encoding;  // "bgr8"; for compressed images "rgb8; jpeg compressed bgr8" and similar
  // Size in pixels and bytes per row; not set for compressed images.
  uint32_t width = 0, height = 0, step = 0;
  bool big_endian = false;
  std::string_view data;
};

// sensor_msgs/CameraInfo, with the message's field names.
struct RosCameraInfo {
  MessageHeader header;
  uint32_t width = 0, height = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{}, R{};  // row-major
  std::array<double, 12> P{};
  uint32_t binning_x = 0, binning_y = 0;
  uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;
};

// All throw Error (input) when the message is damaged.
MessageHeader ParseRosHeader(std::string_view message, Serialization serialization);
RosPicture ParseRosPicture(std::string_view message, Serialization serialization, bool compressed);
RosCameraInfo ParseRosCameraInfo(std::string_view message, Serialization serialization);

}  // namespace alidade
