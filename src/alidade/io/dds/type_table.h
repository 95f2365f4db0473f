// The types of ros2_types.idl by their ROS names.
#pragma once

#include <dds/dds.h>

#include <string>

namespace alidade {

// Of "sensor_msgs/Image"; null: not in ros2_types.idl.
const dds_topic_descriptor_t* DescriptorOf(const std::string& ros_type);

// "sensor_msgs/Image" for "sensor_msgs::msg::dds_::Image_"; empty: not the type of a ROS message.
std::string RosTypeOf(const std::string& dds_type);

// "/camera/image" for the DDS topic "rt/camera/image"; empty: not a ROS topic.
std::string RosTopicOf(const std::string& dds_topic);
std::string DdsTopicOf(const std::string& ros_topic);  // the reverse

}  // namespace alidade
