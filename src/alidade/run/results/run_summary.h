// A run in a few numbers, for who started it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace alidade {

struct RunSummary {
  int frames = 0, tracked = 0;
  int keyframes = 0, landmarks = 0, maps = 0;
  std::optional<int> first_tracked;               // its number in the recording
  std::vector<std::array<double, 2>> lost_spans;  // seconds; not before the start
  size_t shape_points = 0;                        // of semidense.ply
  double path_length = 0;  // through the largest map, metres if `metric`, else map units
  bool metric = true;
};

}  // namespace alidade
