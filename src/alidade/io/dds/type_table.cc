#include "alidade/io/dds/type_table.h"

#include <algorithm>
#include <array>

#include "ros2_types.h"  // by idlc

namespace alidade {
namespace {

constexpr std::string_view kMiddle = "::msg::dds_::", kTopicStart = "rt/";

// Those that are topics by themselves.
const std::array<const dds_topic_descriptor_t*, 14> kTypes = {
    &nav_msgs_msg_dds__OccupancyGrid__desc,
    &std_msgs_msg_dds__Empty__desc,
    &std_msgs_msg_dds__Bool__desc,
    &geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc,
    &tf2_msgs_msg_dds__TFMessage__desc,
    &sensor_msgs_msg_dds__Image__desc,
    &sensor_msgs_msg_dds__CompressedImage__desc,
    &sensor_msgs_msg_dds__CameraInfo__desc,
    &sensor_msgs_msg_dds__Imu__desc,
    &sensor_msgs_msg_dds__PointCloud2__desc,
    &nav_msgs_msg_dds__Odometry__desc,
    &nav_msgs_msg_dds__Path__desc,
    &diagnostic_msgs_msg_dds__DiagnosticArray__desc,
    &rcl_interfaces_msg_dds__Log__desc,
};

}  // namespace

std::string RosTypeOf(const std::string& dds_type) {
  const size_t at = dds_type.find(kMiddle);
  if (at == std::string::npos || dds_type.back() != '_') return {};
  const size_t name = at + kMiddle.size();
  return dds_type.substr(0, at) + "/" + dds_type.substr(name, dds_type.size() - 1 - name);
}

const dds_topic_descriptor_t* DescriptorOf(const std::string& ros_type) {
  const auto found = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto* type) {
    return RosTypeOf(type->m_typename) == ros_type;
  });
  return found == kTypes.end() ? nullptr : *found;
}

std::string RosTopicOf(const std::string& dds_topic) {
  if (dds_topic.compare(0, kTopicStart.size(), kTopicStart) != 0) return {};
  return dds_topic.substr(kTopicStart.size() - 1);
}

std::string DdsTopicOf(const std::string& ros_topic) {
  const bool rooted = !ros_topic.empty() && ros_topic.front() == '/';
  return std::string(kTopicStart) + ros_topic.substr(rooted ? 1 : 0);
}

}  // namespace alidade
