// Chooses the topics of a recording to play.
#pragma once

#include <optional>
#include <string>

#include "alidade/io/files/open_source.h"
#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/source/bag_file.h"
#include "alidade/io/ros/source/picture_topics.h"

namespace alidade {

struct ChosenTopics {
  PictureTopic image;
  std::optional<PictureTopic> right, depth;
  // CameraInfo topics, as indices of the bag's topics; -1: none.
  int info = -1, right_info = -1;
  std::string told;  // the choice and the unused image topics, as a message for users
};

// Uses the topics named in the query. Otherwise prefers an image with registered depth, then the
// left image of a pair, then an image with a CameraInfo. Topics with few messages, or whose names
// indicate derived images (debug, mask, overlay, …), come last. Throws Error: kUsage for topics
// that do not exist, kInput when there are no images.
ChosenTopics ChooseTopics(BagFile& bag, const BagQuery& query, const SourceOptions& options);

}  // namespace alidade
