#include "alidade/io/ros/source/bag_player.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/depth_size.h"
#include "alidade/io/ros/messages/picture_of_message.h"
#include "alidade/io/text.h"

namespace alidade {
BagPlayer::BagPlayer(std::unique_ptr<BagFile> bag, std::string path, const ChosenTopics& chosen,
                     std::optional<double> max_dt)
    : bag_(std::move(bag)),
      path_(std::move(path)),
      image_(chosen.image),
      right_(chosen.right),
      depth_(chosen.depth),
      frames_(*bag_, chosen.image.topic) {
  if (right_) {
    right_stamps_.emplace(*bag_, right_->topic);
    right_finder_.emplace(frames_, *right_stamps_, max_dt.value_or(kPairWithin));
  }
  if (depth_) {
    depth_stamps_.emplace(*bag_, depth_->topic);
    depth_finder_.emplace(frames_, *depth_stamps_, max_dt.value_or(kDepthWithin));
  }
}

void BagPlayer::Begin(SourceInfo info, ImagePreparation preparation, bool color) {
  info_ = std::move(info);
  info_.frames =
      static_cast<int>(std::min<size_t>(frames_.size(), std::numeric_limits<int>::max()));
  preparation_.emplace(std::move(preparation));
  color_ = color;
}

bool BagPlayer::Seek(int frames) {
  next_ = std::clamp(frames, 0, info_.frames);
  return true;
}

DecodedImage BagPlayer::ReadPicture(const PictureTopic& topic, size_t i, ImageUse use) {
  std::string bytes;
  const std::string problem = bag_->Read(bag_->Messages(topic.topic)[i], bytes);
  if (!problem.empty()) ThrowInput(problem);
  return PictureOf(
      ParseRosPicture(bytes, bag_->Topics()[topic.topic].serialization, topic.compressed), use);
}

DecodedImage BagPlayer::Read(const PictureTopic& topic, size_t i, ImageUse use) {
  DecodedImage decoded =
      topic.video ? videos_.try_emplace(topic.topic, *bag_, topic.topic).first->second.Read(i, use)
                  : ReadPicture(topic, i, use);
  if (use == ImageUse::kDepth) decoded.image = ScaledUpDepth(decoded.image, image_.size);
  if (decoded.image.size() != image_.size)
    ThrowInput("is " + SizeText(decoded.image.size()) + ", but " + image_.name + "'s first is " +
               SizeText(image_.size));
  return decoded;
}

cv::Mat BagPlayer::Partner(std::optional<PartnerFinder>& finder, const PictureTopic& topic,
                           size_t i, ImageUse use, SourceFrame& frame) {
  const std::optional<size_t> partner = finder->PartnerOf(i);
  if (!partner) return {};
  try {
    return Read(topic, *partner, use).image;
  } catch (const Error& error) {
    frame.incomplete =
        path_ + ": message " + std::to_string(*partner) + " of " + topic.name + " " + error.what();
    return {};
  }
}

std::optional<SourceFrame> BagPlayer::Next() {
  if (next_ >= info_.frames) return std::nullopt;
  SourceFrame frame;
  frame.number = next_++;
  const size_t i = order_.At(static_cast<size_t>(frame.number));
  if (i != static_cast<size_t>(frame.number) && !std::exchange(told_order_, true)) {
    LogWarning("the time stamps of " + path_ + ", " + image_.name +
               ", are not in order; the frames are sorted by time");
  }
  frame.stamp = StampText(frames_.Stamp(i));
  // The same value that a text list of these stamps would give.
  frame.time = ParseNumber(frame.stamp).value_or(0);
  try {
    const DecodedImage read = Read(image_, i, color_ ? ImageUse::kGrayAndColor : ImageUse::kGray);
    frame.image = preparation_->Left(levels_.To8Bit(read.image, frame.time));
    if (!read.color.empty()) frame.color = preparation_->Left(levels_.ColorTo8Bit(read.color));
  } catch (const Error& error) {
    frame.problem =
        path_ + ": message " + std::to_string(i) + " of " + image_.name + " " + error.what();
    return frame;
  }
  // A frame whose right or depth image is bad is still used as a monocular frame.
  if (info_.sensor == Sensor::kStereo) {
    const cv::Mat right = Partner(right_finder_, *right_, i, ImageUse::kGray, frame);
    if (!right.empty()) frame.right = preparation_->Right(levels_.To8Bit(right, frame.time));
  }
  if (info_.sensor == Sensor::kRgbd) {
    const cv::Mat depth = Partner(depth_finder_, *depth_, i, ImageUse::kDepth, frame);
    if (!depth.empty()) frame.depth = preparation_->Depth(depth);
  }
  return frame;
}

}  // namespace alidade
