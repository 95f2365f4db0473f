#include "alidade/io/ros/source/topic_video.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/media.h"
#include "alidade/io/ros/messages/video_message.h"

namespace alidade {
namespace {

// Messages: the longest wait for a frame that is shown later than it is stored (16 in both
// standards).
constexpr size_t kMostDelay = 16;

}  // namespace

RosPicture TopicVideo::Message(size_t i) {
  const std::string problem = bag_.Read(bag_.Messages(topic_)[i], bytes_);
  if (!problem.empty()) ThrowInput(problem);
  const BagTopic& topic = bag_.Topics()[topic_];
  return topic.type == kVideoType ? ParseVideo(bytes_, topic.serialization)
                                  : ParseRosPicture(bytes_, topic.serialization, true);
}

RosPicture TopicVideo::Head(size_t i) {
  RosPicture picture = Message(i);
  picture.data = {};
  return picture;
}

bool TopicVideo::IsKeyframeMessage(size_t i) {
  try {
    const RosPicture picture = Message(i);
    return IsKeyframe(CodecOfFormat(picture.encoding), picture.data);
  } catch (const Error&) {
    return false;
  }
}

size_t TopicVideo::KeyframeFrom(size_t from) {
  const size_t count = bag_.Messages(topic_).size();
  while (from < count && !IsKeyframeMessage(from)) ++from;
  return from;
}

// Prepares decoding of message i, which was not decoded lately: from the keyframe before, or on
// from where it is, when there is no keyframe in between.
void TopicVideo::GoTo(size_t i) {
  const size_t least = next_ <= i ? next_ : 0;
  size_t keyframe = i;
  while (keyframe > least && !IsKeyframeMessage(keyframe)) --keyframe;
  if (keyframe == next_) return;
  begin_ = next_ = keyframe;
  broken_ = kBeforeKeyframe;
  decoded_.clear();
  problems_.clear();
  if (decoder_) decoder_->Restart();
}

// Takes the frames that are ready.
void TopicVideo::Collect() {
  int64_t number = 0;
  cv::Mat color;
  for (;;) {
    switch (decoder_->Receive(number, color)) {
      case PacketDecoder::Received::kNone:
        return;
      case PacketDecoder::Received::kImage:
        decoded_[static_cast<size_t>(number)] = color;
        break;
      case PacketDecoder::Received::kDamaged:
        ThrowInput("is damaged: it cannot be decoded");
    }
  }
}

// Decodes message next_, and counts it.
void TopicVideo::Feed() {
  const size_t i = next_++;
  try {
    const RosPicture picture = Message(i);
    const PacketCodec codec = CodecOfFormat(picture.encoding);
    if (IsKeyframe(codec, picture.data)) {
      if (!broken_.empty() && decoder_) decoder_->Restart();
      broken_.clear();
    }
    if (!broken_.empty()) ThrowInput(broken_);
    if (!decoder_) decoder_ = OpenPacketDecoder(codec);
    const bool sent =
        decoder_->Send(picture.data.data(), picture.data.size(), static_cast<int64_t>(i));
    if (!sent) ThrowInput("is damaged: it cannot be decoded");
    Collect();
  } catch (const Error& error) {
    problems_[i] = error.what();
    if (broken_.empty())
      broken_ = "cannot be decoded: message " + std::to_string(i) +
                ", to which it refers, is damaged, and no keyframe has come since";
  }
}

void TopicVideo::Forget(size_t before) {
  decoded_.erase(decoded_.begin(), decoded_.lower_bound(before));
  problems_.erase(problems_.begin(), problems_.lower_bound(before));
}

DecodedImage TopicVideo::Read(size_t i, ImageUse use) {
  if (use == ImageUse::kDepth) ThrowInput("is video, not a depth image");
  const size_t count = bag_.Messages(topic_).size();
  // Frames are asked for in order, but for a few (PlayOrder).
  const bool lately = begin_ <= i && i <= next_ && next_ <= i + kMostDelay;
  if (!lately) GoTo(i);
  const auto is_done = [&] { return decoded_.count(i) != 0 || problems_.count(i) != 0; };
  const size_t oldest = i - std::min(i, kMostDelay);
  for (Forget(oldest); !is_done() && next_ < count && next_ <= i + kMostDelay; Forget(oldest))
    Feed();
  if (!is_done() && next_ == count && decoder_) {
    try {
      if (decoder_->End()) Collect();
    } catch (const Error& error) {
      problems_[i] = error.what();
    }
  }
  const auto found = decoded_.find(i);
  const auto problem = problems_.find(i);
  if (found == decoded_.end())
    ThrowInput(problem == problems_.end() ? "holds no frame of the video" : problem->second);
  DecodedImage decoded;
  cv::cvtColor(found->second, decoded.image, cv::COLOR_BGR2GRAY);
  if (use == ImageUse::kGrayAndColor) decoded.color = found->second;
  return decoded;
}

}  // namespace alidade
