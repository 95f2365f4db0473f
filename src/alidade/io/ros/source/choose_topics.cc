#include "alidade/io/ros/source/choose_topics.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "alidade/base/error.h"
#include "alidade/io/files/depth_size.h"

namespace alidade {
namespace {

bool HasWord(const std::string& text, const std::string& word) {
  return text.find(word) != std::string::npos;
}

// Lists the recording's topics, for error messages.
std::string AllTopics(const BagFile& bag) {
  constexpr size_t kMostListed = 20;
  std::string list;
  const size_t count = bag.Topics().size();
  for (size_t i = 0; i < std::min(count, kMostListed); ++i) {
    const BagTopic& topic = bag.Topics()[i];
    list += (i == 0 ? "" : ", ") + topic.name + " (" + topic.type + ", " +
            std::to_string(topic.messages) + ")";
  }
  if (count > kMostListed) list += " and " + std::to_string(count - kMostListed) + " more";
  return list.empty() ? "no topics at all" : list;
}

std::string ListOf(const std::vector<PictureTopic>& pictures, bool depth) {
  std::string list;
  for (const PictureTopic& picture : pictures) {
    if (picture.depth == depth) list += (list.empty() ? "" : ", ") + picture.name;
  }
  return list.empty() ? "none" : list;
}

class Chooser {
 public:
  Chooser(BagFile& bag, const BagQuery& query, const SourceOptions& options)
      : bag_(bag), query_(query), options_(options), pictures_(PictureTopicsOf(bag)) {}

  ChosenTopics Choose() {
    if (pictures_.empty()) {
      ThrowInput(query_.path +
                 " contains no images (sensor_msgs Image or CompressedImage, foxglove "
                 "CompressedVideo); it has " +
                 AllTopics(bag_));
    }
    ChosenTopics chosen;
    chosen.image = query_.image ? Named("image", *query_.image) : Best();
    if (WantsDepth()) chosen.depth = DepthFor(chosen.image);
    if (WantsRight() && !(chosen.depth && !options_.sensor)) chosen.right = RightFor(chosen.image);
    chosen.info = InfoFor("info", query_.info, chosen.image);
    if (chosen.right) chosen.right_info = InfoFor("right_info", query_.right_info, *chosen.right);
    chosen.told = Told(chosen);
    return chosen;
  }

 private:
  bool WantsDepth() const {
    return options_.sensor.value_or(Sensor::kRgbd) == Sensor::kRgbd &&
           !(query_.depth && query_.depth->empty()) && !(query_.right && !query_.depth);
  }
  bool WantsRight() const {
    return options_.sensor.value_or(Sensor::kStereo) == Sensor::kStereo &&
           !(query_.right && query_.right->empty());
  }

  PictureTopic Named(const std::string& option, const std::string& name) const {
    for (const PictureTopic& picture : pictures_) {
      if (picture.name != name) continue;
      if (!picture.problem.empty()) ThrowInput(query_.path + ": " + name + " " + picture.problem);
      return picture;
    }
    ThrowUsage(option + "=" + name + ": there is no such topic with images in " + query_.path +
               "; there are " + ListOf(pictures_, false) + "; depth: " + ListOf(pictures_, true));
  }

  // true when each depth pixel corresponds to the pixel of `image` with the same coordinates, or to
  // a block of n x n pixels. Drivers state this by a common frame_id or by the topic's name.
  static bool IsRegistered(const PictureTopic& depth, const PictureTopic& image) {
    if (!depth.depth || !depth.problem.empty()) return false;
    if (depth.size != image.size && !IsWholeFraction(depth.size, image.size)) return false;
    if (depth.frame_id == image.frame_id) return true;
    if (HasWord(depth.base, "depth_registered")) return true;
    const size_t aligned = depth.base.find("aligned_depth_to_");
    if (aligned == std::string::npos) return false;
    const size_t from = aligned + std::string("aligned_depth_to_").size();
    const std::string view = depth.base.substr(from, depth.base.find('/', from) - from);
    return HasWord(image.base, view);
  }

  std::optional<PictureTopic> DepthFor(const PictureTopic& image) const {
    if (query_.depth) {
      PictureTopic depth = Named("depth", *query_.depth);
      if (depth.size != image.size && !IsWholeFraction(depth.size, image.size))
        ThrowUsage("depth=" + depth.name + " has " + SizeText(depth.size) + ", but " + image.name +
                   " has " + SizeText(image.size) +
                   ": only depth that is registered to the image can be used, of the same size or "
                   "a half, a third, … of it");
      return depth;
    }
    const PictureTopic* best = nullptr;
    for (const PictureTopic& depth : pictures_) {
      if (!IsRegistered(depth, image)) continue;
      const auto rank = [](const PictureTopic& topic) {
        return std::make_tuple(topic.size.area(), !topic.compressed, topic.messages);
      };
      if (!best || rank(depth) > rank(*best)) best = &depth;
    }
    return best ? std::optional(*best) : std::nullopt;
  }

  std::optional<PictureTopic> RightFor(const PictureTopic& image) const {
    if (query_.right) return Named("right", *query_.right);
    const std::string name = RightNameOf(image.name);
    for (const PictureTopic& picture : pictures_) {
      if (picture.name == name && !picture.depth && picture.problem.empty() &&
          picture.size == image.size)
        return picture;
    }
    return std::nullopt;
  }

  int InfoFor(const char* option, const std::optional<std::string>& asked,
              const PictureTopic& picture) const {
    if (!asked) return InfoTopicOf(bag_, picture);
    if (asked->empty()) return -1;
    for (size_t i = 0; i < bag_.Topics().size(); ++i) {
      if (bag_.Topics()[i].name == *asked && IsInfoType(bag_.Topics()[i].type) &&
          !bag_.Messages(i).empty())
        return static_cast<int>(i);
    }
    ThrowUsage(std::string(option) + "=" + *asked +
               ": there is no such topic with a CameraInfo in " + query_.path + "; it has " +
               AllTopics(bag_));
  }

  // Larger scores are preferred; Best() breaks ties by the number of messages, then by name. The
  // terms are ordered by weight.
  int Score(const PictureTopic& image, int64_t most_messages) const {
    constexpr std::array<const char*, 7> kMadeOfOthers = {
        "debug", "mask", "overlay", "detect", "feature", "disparity", "annotat"};
    int score = 0;
    if (image.messages * 5 < most_messages) score -= 1000;
    for (const char* word : kMadeOfOthers) score -= HasWord(image.base, word) ? 500 : 0;
    if (WantsDepth() && DepthFor(image)) score += 100;
    if (WantsRight() && RightFor(image)) score += 50;
    if (InfoTopicOf(bag_, image) >= 0) score += 20;
    if (!RightNameOf(image.name).empty()) score += 10;  // prefer cam0 to cam1
    if (HasWord(image.base, "rgb") || HasWord(image.base, "color")) score += 5;
    if (!image.compressed) score += 1;
    return score;
  }

  PictureTopic Best() const {
    int64_t most = 0;
    std::string problem;
    for (const PictureTopic& picture : pictures_) {
      if (!picture.problem.empty()) {
        problem = picture.name + " " + picture.problem;
      } else if (!picture.depth) {
        most = std::max(most, picture.messages);
      }
    }
    const PictureTopic* best = nullptr;
    std::pair<int, int64_t> best_score;
    for (const PictureTopic& picture : pictures_) {
      if (picture.depth || !picture.problem.empty()) continue;
      const std::pair<int, int64_t> score{Score(picture, most), picture.messages};
      if (best && score <= best_score) continue;
      best = &picture;
      best_score = score;
    }
    if (best) return *best;
    if (!problem.empty()) ThrowInput(query_.path + ": " + problem);
    ThrowInput(query_.path + " contains only depth (" + ListOf(pictures_, true) +
               "), no images; it has " + AllTopics(bag_));
  }

  std::string Told(const ChosenTopics& chosen) const {
    std::string told = "Topics: image " + InWords(chosen.image);
    if (chosen.right) told += ", right " + InWords(*chosen.right);
    if (chosen.depth) told += ", depth " + InWords(*chosen.depth);
    const auto name = [&](int topic) { return bag_.Topics()[static_cast<size_t>(topic)].name; };
    if (chosen.info >= 0) told += ", calibration " + name(chosen.info);
    if (chosen.right_info >= 0) told += " and " + name(chosen.right_info);
    std::string rest;
    for (const PictureTopic& picture : pictures_) {
      const bool taken = picture.topic == chosen.image.topic ||
                         (chosen.right && picture.topic == chosen.right->topic) ||
                         (chosen.depth && picture.topic == chosen.depth->topic);
      if (taken) continue;
      rest += (rest.empty() ? "" : ", ") + picture.name + (picture.depth ? " (depth)" : "");
    }
    if (!rest.empty()) told += "; not used: " + rest + " (SOURCE?image=TOPIC&depth=TOPIC selects)";
    if (chosen.depth && chosen.depth->size != chosen.image.size)
      told += "\n" + DepthSizeTold(chosen.depth->size, chosen.image.size);
    return told;
  }

  BagFile& bag_;
  const BagQuery& query_;
  const SourceOptions& options_;
  std::vector<PictureTopic> pictures_;
};

}  // namespace

ChosenTopics ChooseTopics(BagFile& bag, const BagQuery& query, const SourceOptions& options) {
  return Chooser(bag, query, options).Choose();
}

}  // namespace alidade
