// Single frames of a video: foxglove.CompressedVideo (in Protocol Buffers, ROS 1 and ROS 2), and
// sensor_msgs/CompressedImage with the format "h264" or "h265".
#pragma once

#include <string>
#include <string_view>

#include "alidade/io/media/media_module.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

// Both throw Error (input) when the message is damaged. `message` of ParseVideoHeader() may be cut
// behind the header. Format and bytes are `encoding` and `data` of the picture.
MessageHeader ParseVideoHeader(std::string_view message, Serialization serialization);
RosPicture ParseVideo(std::string_view message, Serialization serialization);

// true for the format of a CompressedImage that holds a frame of a video.
bool IsVideoFormat(const std::string& format);

// Throws Error (input) naming the formats that are read when `format` is another one.
PacketCodec CodecOfFormat(const std::string& format);

// true when decoding can begin with this packet: a picture that refers to no other (an IDR picture
// of H.264, an IRAP picture of H.265). `packet` is a byte stream (Annex B of either standard).
bool IsKeyframe(PacketCodec codec, std::string_view packet);

}  // namespace alidade
