#include "alidade/io/ros/messages/video_message.h"

#include <cctype>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/printable.h"
#include "alidade/io/ros/messages/message_cursor.h"
#include "alidade/io/ros/messages/protobuf_cursor.h"

namespace alidade {
namespace {

int64_t Nanoseconds(int64_t seconds, int64_t rest) {
  int64_t stamp = 0;
  return __builtin_mul_overflow(seconds, int64_t{1'000'000'000}, &stamp) ||
                 __builtin_add_overflow(stamp, rest, &stamp)
             ? 0
             : stamp;
}

// google.protobuf.Timestamp: seconds and nanoseconds.
int64_t StampOf(std::string_view message) {
  ProtobufCursor cursor(message);
  int64_t seconds = 0, nanoseconds = 0;
  while (const auto field = cursor.Next()) {
    if (field->number == 1) seconds = static_cast<int64_t>(field->value);
    if (field->number == 2) nanoseconds = static_cast<int64_t>(field->value);
  }
  return Nanoseconds(seconds, nanoseconds);
}

RosPicture ParseProtobufVideo(std::string_view message, bool header_only) {
  ProtobufCursor cursor(message);
  RosPicture picture;
  picture.compressed = true;
  try {
    while (const auto field = cursor.Next()) {
      if (field->number == 1) picture.header.stamp = StampOf(field->bytes);
      if (field->number == 2) picture.header.frame_id = field->bytes;
      if (field->number == 3) picture.data = field->bytes;
      if (field->number == 4) picture.encoding = Printable(field->bytes);
    }
  } catch (const Error&) {
    // The header's fields come first; the message may be cut behind them.
    if (!header_only || picture.header.stamp == 0) throw;
  }
  return picture;
}

// Without the sequence number of a std_msgs/Header.
MessageHeader TakeVideoHeader(MessageCursor& cursor) {
  MessageHeader header;
  const uint32_t seconds = cursor.Uint32(), nanoseconds = cursor.Uint32();
  header.stamp = Nanoseconds(seconds, nanoseconds);
  header.frame_id = cursor.Text();
  return header;
}

std::optional<PacketCodec> KnownCodec(const std::string& format) {
  std::string name;
  for (const char c : format.substr(0, format.find_first_of("; "))) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  if (name == "h264" || name == "avc") return PacketCodec::kH264;
  if (name == "h265" || name == "hevc") return PacketCodec::kH265;
  return std::nullopt;
}

}  // namespace

MessageHeader ParseVideoHeader(std::string_view message, Serialization serialization) {
  if (serialization == Serialization::kProtobuf) return ParseProtobufVideo(message, true).header;
  MessageCursor cursor(message, serialization);
  return TakeVideoHeader(cursor);
}

RosPicture ParseVideo(std::string_view message, Serialization serialization) {
  if (serialization == Serialization::kProtobuf) return ParseProtobufVideo(message, false);
  MessageCursor cursor(message, serialization);
  RosPicture picture;
  picture.compressed = true;
  picture.header = TakeVideoHeader(cursor);
  picture.data = cursor.Bytes();
  picture.encoding = Printable(cursor.Text());
  return picture;
}

bool IsVideoFormat(const std::string& format) { return KnownCodec(format).has_value(); }

PacketCodec CodecOfFormat(const std::string& format) {
  if (const auto codec = KnownCodec(format)) return *codec;
  ThrowInput("is video of the format `" + format.substr(0, 40) +
             "`, which is not read; read are h264 and h265 (Annex B)");
}

bool IsKeyframe(PacketCodec codec, std::string_view packet) {
  constexpr std::string_view kStart("\0\0\1", 3);  // before each unit
  for (size_t at = packet.find(kStart); at != std::string_view::npos;
       at = packet.find(kStart, at + 3)) {
    if (at + 3 >= packet.size()) return false;
    const auto head = static_cast<uint8_t>(packet[at + 3]);
    // Types of units: ITU-T H.264, table 7-1; ITU-T H.265, table 7-1.
    const int type = codec == PacketCodec::kH264 ? head & 31 : head >> 1 & 63;
    if (codec == PacketCodec::kH264 ? type == 5 : type >= 16 && type <= 23) return true;
  }
  return false;
}

}  // namespace alidade
