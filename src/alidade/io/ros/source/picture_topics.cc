#include "alidade/io/ros/source/picture_topics.h"

#include <algorithm>
#include <array>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/ros/messages/foxglove_calibration.h"
#include "alidade/io/ros/messages/picture_of_message.h"
#include "alidade/io/ros/messages/video_message.h"
#include "alidade/io/ros/source/topic_video.h"

namespace alidade {
namespace {

constexpr size_t kTries = 5;  // messages read per topic, because the first may be damaged

bool Holds(const std::string& text, const char* word) {
  return text.find(word) != std::string::npos;
}

std::string BaseOf(const std::string& name) {
  for (const std::string transport : {"/compressed", "/compressedDepth"}) {
    if (name.size() > transport.size() &&
        name.compare(name.size() - transport.size(), transport.size(), transport) == 0)
      return name.substr(0, name.size() - transport.size());
  }
  return name;
}

std::string FolderOfTopic(const std::string& name) {
  const size_t slash = name.rfind('/');
  return slash == std::string::npos ? "" : name.substr(0, slash);
}

// A recording may begin in the middle of a video.
void LookAtVideo(BagFile& bag, PictureTopic& picture) {
  TopicVideo video(bag, picture.topic);
  picture.video = true;
  picture.problem = "is video without a keyframe, at which decoding could begin";
  const size_t count = bag.Messages(picture.topic).size();
  size_t i = video.KeyframeFrom(0);
  for (size_t tries = 0; i < count && tries < kTries; ++tries, i = video.KeyframeFrom(i + 1)) {
    try {
      picture.size = video.Read(i, ImageUse::kGray).image.size();
      if (!IsPictureSize(picture.size.width, picture.size.height))
        ThrowInput("cannot be used: " + TooLargeText(picture.size.width, picture.size.height));
      picture.problem.clear();
      return;
    } catch (const Error& error) {
      if (tries == 0) picture.problem = error.what();
    }
  }
}

// Sets `video` for the frames of a video, and their format; false when the first messages cannot be
// read.
bool FindVideo(BagFile& bag, PictureTopic& picture) {
  TopicVideo video(bag, picture.topic);
  for (size_t i = 0; i < std::min(bag.Messages(picture.topic).size(), kTries); ++i) {
    try {
      const RosPicture head = video.Head(i);
      picture.encoding = head.encoding;
      picture.frame_id = head.header.frame_id;
      if (bag.Topics()[picture.topic].type != kVideoType && !IsVideoFormat(head.encoding))
        return false;
      CodecOfFormat(head.encoding);
      return true;
    } catch (const Error& error) {
      picture.problem = error.what();
    }
  }
  return false;
}

void LookAt(BagFile& bag, PictureTopic& picture) {
  picture.problem.clear();
  const BagTopic& topic = bag.Topics()[picture.topic];
  const std::vector<BagMessage>& messages = bag.Messages(picture.topic);
  std::string bytes;
  for (size_t i = 0; i < std::min(messages.size(), kTries); ++i) {
    std::string problem = bag.Read(messages[i], bytes);
    try {
      if (!problem.empty()) ThrowInput(problem);
      const RosPicture first = ParseRosPicture(bytes, topic.serialization, picture.compressed);
      picture.encoding = first.encoding;
      picture.frame_id = first.header.frame_id;
      picture.size = SizeOfPicture(first);
      picture.depth =
          IsDepth(first) || (first.encoding == "mono16" && Holds(picture.base, "depth"));
      CheckEncoding(first);
      if (picture.size.empty()) ThrowInput("has no size, or a damaged header");
      if (!IsPictureSize(picture.size.width, picture.size.height))
        ThrowInput("cannot be used: " + TooLargeText(picture.size.width, picture.size.height));
      picture.problem.clear();
      return;
    } catch (const Error& error) {
      if (picture.problem.empty()) picture.problem = error.what();
    }
  }
}

}  // namespace

std::vector<PictureTopic> PictureTopicsOf(BagFile& bag) {
  std::vector<PictureTopic> pictures;
  for (size_t i = 0; i < bag.Topics().size(); ++i) {
    const BagTopic& topic = bag.Topics()[i];
    const bool compressed = topic.type == "sensor_msgs/CompressedImage" || topic.type == kVideoType;
    if ((topic.type != "sensor_msgs/Image" && !compressed) || bag.Messages(i).empty()) continue;
    PictureTopic picture;
    picture.topic = i;
    picture.name = topic.name;
    picture.base = BaseOf(topic.name);
    picture.compressed = compressed;
    picture.messages = static_cast<int64_t>(bag.Messages(i).size());
    const std::string last = picture.base.substr(FolderOfTopic(picture.base).size());
    picture.rectified = last.rfind("/image_rect", 0) == 0 ||
                        (Holds(picture.base, "rectified") && !Holds(picture.base, "unrectified"));
    if (compressed && FindVideo(bag, picture)) {
      LookAtVideo(bag, picture);
    } else if (topic.type != kVideoType) {
      LookAt(bag, picture);
    }
    pictures.push_back(std::move(picture));
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const PictureTopic& a, const PictureTopic& b) { return a.name < b.name; });
  // Infrared cameras deliver 16UC1 as well. When the recording has no other image topic, a 16UC1
  // topic without "depth" in its name counts as an image.
  const bool others = std::any_of(
      pictures.begin(), pictures.end(),
      [](const PictureTopic& picture) { return !picture.depth && picture.problem.empty(); });
  for (PictureTopic& picture : pictures) {
    if (!others && picture.encoding == "16UC1" && !Holds(picture.base, "depth"))
      picture.depth = false;
  }
  return pictures;
}

std::string InWords(const PictureTopic& picture) {
  const std::string format = picture.encoding.substr(0, 40);
  return picture.name + " (" + (format.empty() ? "" : format + ", ") +
         std::to_string(picture.size.width) + "x" + std::to_string(picture.size.height) + ", " +
         std::to_string(picture.messages) + " messages)";
}

std::string RightNameOf(const std::string& name) {
  constexpr std::array<std::pair<const char*, const char*>, 9> kWords = {
      {{"left", "right"},
       {"Left", "Right"},
       {"cam0", "cam1"},
       {"cam_0", "cam_1"},
       {"camera0", "camera1"},
       {"camera_0", "camera_1"},
       {"infra1", "infra2"},
       {"image_00", "image_01"},
       {"image_02", "image_03"}}};
  for (const auto& [left, right] : kWords) {
    std::string other = name;
    const std::string word = left;
    bool any = false;
    for (size_t at = other.find(word); at != std::string::npos;
         at = other.find(word, at + std::string(right).size())) {
      other.replace(at, word.size(), right);
      any = true;
    }
    if (any) return other;
  }
  return {};
}

int InfoTopicOf(BagFile& bag, const PictureTopic& picture) {
  const std::string beside = FolderOfTopic(picture.base) + "/camera_info";
  std::vector<int> of_frame;
  for (size_t i = 0; i < bag.Topics().size(); ++i) {
    if (!IsInfoType(bag.Topics()[i].type) || bag.Messages(i).empty()) continue;
    if (bag.Topics()[i].name == beside) return static_cast<int>(i);
    try {
      const RosCameraInfo info = FirstInfo(bag, i);
      if (info.header.frame_id == picture.frame_id && !picture.frame_id.empty() &&
          static_cast<int>(info.width) == picture.size.width &&
          static_cast<int>(info.height) == picture.size.height)
        of_frame.push_back(static_cast<int>(i));
    } catch (const Error&) {  // a CameraInfo that cannot be read is skipped
    }
  }
  return of_frame.size() == 1 ? of_frame.front() : -1;
}

RosCameraInfo FirstInfo(BagFile& bag, size_t topic) {
  const std::vector<BagMessage>& messages = bag.Messages(topic);
  std::string problem = "has no messages", bytes;
  for (size_t i = 0; i < std::min(messages.size(), kTries); ++i) {
    std::string failure = bag.Read(messages[i], bytes);
    try {
      if (!failure.empty()) ThrowInput(failure);
      const BagTopic& of = bag.Topics()[topic];
      return of.type == kCalibrationType ? ParseFoxgloveCalibration(bytes, of.serialization)
                                         : ParseRosCameraInfo(bytes, of.serialization);
    } catch (const Error& error) {
      problem = error.what();
    }
  }
  ThrowInput(problem);
}

}  // namespace alidade
