// Inertial readings of a ROS recording: sensor_msgs/Imu.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/ros/source/bag_file.h"
#include "alidade/io/ros/source/picture_topics.h"
#include "alidade/io/wrappers.h"

namespace alidade {

struct ImuUnits {
  double rate = 1, force = 1;
};

struct BagImu {
  std::optional<ImuRecording> recording;  // of the camera as mounted; nullopt: none
  std::string told;                       // the choice, as part of a sentence; empty: none
  // Indices of the topics with angular rates and accelerations, often the same; -1: none.
  int rate_topic = -1, force_topic = -1;
  // What the messages' numbers were multiplied by to get rad/s and m/s².
  ImuUnits units;
};

// Reads the topic that query.imu names ("/imu", or "/gyro,/accel"), else the one with both
// quantities whose name begins most like that of the images, else a gyroscope and an accelerometer
// that publish apart: a topic whose other quantity is 0 throughout. Those are put on one clock
// (OnOneClock()). The sensor's place is that of /tf_static between the frames of the messages, and
// unknown without it. Warns of messages that cannot be read. Reads all inertial messages, and for
// that unpacks all chunks that contain some. Throws Error (usage) for a topic that does not exist.
BagImu ReadBagImu(BagFile& bag, const BagQuery& query, const PictureTopic& image);

}  // namespace alidade
