// Which topics of a recording are taken.
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
  // Calibrations, as topics of the bag; -1: none.
  int info = -1, right_info = -1;
  std::string told;  // all of it in words, and what else there was to choose from
};

// What the query names; for the rest, the camera with depth of its own view, else the left one of a
// pair, else the one that tells its calibration; pictures of few messages, or whose name says that
// they are made of others, last. Throws Error: kUsage for topics that are not there, kInput when
// there are no pictures.
ChosenTopics ChooseTopics(BagFile& bag, const BagQuery& query, const SourceOptions& options);

}  // namespace alidade
