// Messages that cameras' drivers publish, as CDR.
#pragma once

#include <cstring>
#include <opencv2/core.hpp>
#include <string>

#include "alidade/ros/cdr.h"
#include "alidade/ros/ros_messages.h"

namespace alidade {

inline constexpr char kImageType[] = "sensor_msgs::msg::dds_::Image_";
inline constexpr char kImuMessageType[] = "sensor_msgs::msg::dds_::Imu_";
inline constexpr char kInfoType[] = "sensor_msgs::msg::dds_::CameraInfo_";

// sensor_msgs/Image of a gray (mono8) or 16-bit depth (16UC1) image.
inline std::string EncodeRawImage(double time, const std::string& frame_id, const cv::Mat& image) {
  const RosTime stamp = RosTime::FromSeconds(time);
  CdrWriter out;
  out.Add(stamp.sec);
  out.Add(stamp.nanosec);
  out.AddText(frame_id);
  out.Add(static_cast<uint32_t>(image.rows));
  out.Add(static_cast<uint32_t>(image.cols));
  out.AddText(image.type() == CV_16UC1 ? "16UC1" : "mono8");
  out.Add(static_cast<uint8_t>(0));
  const auto step = static_cast<size_t>(image.cols) * image.elemSize();
  out.Add(static_cast<uint32_t>(step));
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  out.AddBytes({reinterpret_cast<const char*>(whole.data), step * static_cast<size_t>(image.rows)});
  return out.Take();
}

// sensor_msgs/Imu without an orientation.
inline std::string EncodeImu(double time, const std::string& frame_id, const Eigen::Vector3d& rate,
                             const Eigen::Vector3d& force) {
  const RosTime stamp = RosTime::FromSeconds(time);
  CdrWriter out;
  out.Add(stamp.sec);
  out.Add(stamp.nanosec);
  out.AddText(frame_id);
  const auto add = [&](const Eigen::Vector3d& vector) {
    for (const double value : vector) out.Add(value);
    for (int i = 0; i < 9; ++i) out.Add(0.0);  // covariance
  };
  for (const double value : {0.0, 0.0, 0.0, 1.0}) out.Add(value);
  for (int i = 0; i < 9; ++i) out.Add(i == 0 ? -1.0 : 0.0);  // no orientation
  add(rate);
  add(force);
  return out.Take();
}

// Nanoseconds of the first transform of a tf2_msgs/TFMessage.
inline int64_t FirstStampOf(const std::string& transforms) {
  int32_t sec = 0;
  uint32_t nanosec = 0;
  std::memcpy(&sec, transforms.data() + 8, sizeof sec);  // after CDR's header and the count
  std::memcpy(&nanosec, transforms.data() + 12, sizeof nanosec);
  return int64_t{sec} * 1000000000 + nanosec;
}

}  // namespace alidade
