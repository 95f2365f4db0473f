// A topic whose messages are the frames of one video, most of which refer to earlier ones.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/media/media_module.h"
#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/messages/messages.h"

namespace alidade {

class TopicVideo {
 public:
  // `bag` must outlive this object.
  TopicVideo(BagFile& bag, size_t topic) : bag_(bag), topic_(topic) {}

  // The frame of message i. In order, each message is decoded once; elsewhere decoding begins with
  // the keyframe before. Throws Error (input) when the frame cannot be decoded: it is damaged,
  // comes before the first keyframe, or between a damaged frame and the next keyframe.
  DecodedImage Read(size_t i, ImageUse use);

  // Index of the first keyframe from message `from` on; the number of messages when there is none.
  size_t KeyframeFrom(size_t from);
  // Format and frame_id of message i.
  RosPicture Head(size_t i);

 private:
  RosPicture Message(size_t i);  // refers to bytes_
  bool IsKeyframeMessage(size_t i);
  void GoTo(size_t i);
  void Feed();
  void Collect();
  void Forget(size_t before);

  BagFile& bag_;
  size_t topic_;
  std::string bytes_;
  std::unique_ptr<PacketDecoder> decoder_;
  std::map<size_t, cv::Mat> decoded_;  // frames by their messages, not yet asked for
  size_t begin_ = 0, next_ = 0;        // messages where decoding began, and to decode next
  static constexpr char kBeforeKeyframe[] = "comes before the first keyframe of the video";
  // Why messages up to the next keyframe are not decoded; empty: they are.
  std::string broken_ = kBeforeKeyframe;
  std::map<size_t, std::string> problems_;  // of messages that were not decoded
};

}  // namespace alidade
