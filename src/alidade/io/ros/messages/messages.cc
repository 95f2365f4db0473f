#include "alidade/io/ros/messages/messages.h"

#include "alidade/base/error.h"
#include "alidade/base/printable.h"
#include "alidade/io/ros/messages/message_cursor.h"

namespace alidade {
namespace {

constexpr uint32_t kMostCoefficients = 64;  // of a lens; the longest model has 14

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
