// What semi-dense mapping has done so far.
#pragma once

#include <cstddef>
#include <cstdint>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct SearchCount {
  int64_t searches = 0;  // epipolar lines that were walked
  int64_t samples = 0;   // places on them
};

struct SemiDenseReport {
  int keyframes = 0;   // worked on, each time counted
  int64_t pixels = 0;  // with enough gradient, in those
  SearchCount search;
  int most_behind = 0;  // keyframes that waited at once, whose turn had come
  int let_go = 0;       // keyframes that stay without depth: too many waited (max_waiting)
  size_t bytes = 0;     // that are held now, the finished depth in the map included
};

}  // namespace alidade
