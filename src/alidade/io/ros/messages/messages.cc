#include "alidade/io/ros/messages/messages.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/printable.h"
#include "alidade/io/ros/messages/message_cursor.h"

namespace alidade {
namespace {

constexpr uint32_t kMostCoefficients = 64;  // of a lens; the longest model has 14
constexpr uint32_t kMostTransforms = 10'000;

MessageHeader TakeHeader(MessageCursor& cursor) {
  if (!cursor.cdr()) cursor.Uint32();  // sequence number, ROS 1 only
  MessageHeader header;
  // ROS 2's seconds are signed; times before 1970 are not supported.
  const uint32_t seconds = cursor.Uint32(), nanoseconds = cursor.Uint32();
  header.stamp = int64_t{seconds} * 1'000'000'000 + nanoseconds;
  header.frame_id = cursor.Text();
  return header;
}

template <size_t N>
std::array<double, N> TakeDoubles(MessageCursor& cursor) {
  std::array<double, N> values;
  for (double& value : values) value = cursor.Double();
  return values;
}

Eigen::Vector3d TakeVector(MessageCursor& cursor) {
  const double x = cursor.Double(), y = cursor.Double();
  return {x, y, cursor.Double()};
}

}  // namespace

MessageHeader ParseRosHeader(std::string_view message, Serialization serialization) {
  MessageCursor cursor(message, serialization);
  return TakeHeader(cursor);
}

RosPicture ParseRosPicture(std::string_view message, Serialization serialization, bool compressed) {
  MessageCursor cursor(message, serialization);
  RosPicture picture;
  picture.header = TakeHeader(cursor);
  picture.compressed = compressed;
  if (!compressed) {
    picture.height = cursor.Uint32();
    picture.width = cursor.Uint32();
  }
  picture.encoding = Printable(cursor.Text());
  if (!compressed) {
    picture.big_endian = cursor.Byte() != 0;
    picture.step = cursor.Uint32();
  }
  picture.data = cursor.Bytes();
  return picture;
}

RosImu ParseRosImu(std::string_view message, Serialization serialization) {
  MessageCursor cursor(message, serialization);
  RosImu imu;
  imu.header = TakeHeader(cursor);
  TakeDoubles<4>(cursor);  // orientation
  TakeDoubles<9>(cursor);
  imu.angular_velocity = TakeVector(cursor);
  imu.has_rate = TakeDoubles<9>(cursor)[0] != -1;
  imu.linear_acceleration = TakeVector(cursor);
  imu.has_force = TakeDoubles<9>(cursor)[0] != -1;
  return imu;
}

std::vector<RosFrame> ParseRosTransforms(std::string_view message, Serialization serialization) {
  MessageCursor cursor(message, serialization);
  const uint32_t count = cursor.Uint32();
  if (count > kMostTransforms) ThrowInput("has too many transforms");
  std::vector<RosFrame> frames;
  for (uint32_t i = 0; i < count; ++i) {
    RosFrame frame;
    frame.parent = TakeHeader(cursor).frame_id;
    frame.child = cursor.Text();
    frame.T_parent_child.t = TakeVector(cursor);
    const Eigen::Vector3d axis = TakeVector(cursor);
    Eigen::Quaterniond q(cursor.Double(), axis.x(), axis.y(), axis.z());
    if (!(std::abs(q.norm() - 1) < 0.01) || !frame.T_parent_child.t.allFinite()) continue;
    frame.T_parent_child.R = q.normalized().toRotationMatrix();
    // ROS 1 once began names with a slash.
    for (std::string* name : {&frame.parent, &frame.child}) {
      if (!name->empty() && name->front() == '/') name->erase(0, 1);
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

RosCameraInfo ParseRosCameraInfo(std::string_view message, Serialization serialization) {
  MessageCursor cursor(message, serialization);
  RosCameraInfo info;
  info.header = TakeHeader(cursor);
  info.height = cursor.Uint32();
  info.width = cursor.Uint32();
  info.distortion_model = Printable(cursor.Text());
  const uint32_t coefficients = cursor.Uint32();
  if (coefficients > kMostCoefficients) ThrowInput("has too many distortion coefficients");
  for (uint32_t i = 0; i < coefficients; ++i) info.D.push_back(cursor.Double());
  info.K = TakeDoubles<9>(cursor);
  info.R = TakeDoubles<9>(cursor);
  info.P = TakeDoubles<12>(cursor);
  info.binning_x = cursor.Uint32();
  info.binning_y = cursor.Uint32();
  info.roi_x = cursor.Uint32();
  info.roi_y = cursor.Uint32();
  info.roi_height = cursor.Uint32();
  info.roi_width = cursor.Uint32();
  return info;
}

}  // namespace alidade
