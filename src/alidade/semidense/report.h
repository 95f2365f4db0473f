// Statistics of semi-dense mapping.
#pragma once

#include <cstddef>
#include <cstdint>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

struct SearchCount {
  int64_t searches = 0;  // epipolar lines searched
  int64_t samples = 0;   // positions compared on them
};

struct SemiDenseReport {
  int keyframes = 0;   // processed, counted each time
  int64_t pixels = 0;  // with sufficient gradient, in those keyframes
  SearchCount search;
  int most_behind = 0;  // largest number of keyframes that were due but not processed yet
  int let_go = 0;       // keyframes skipped because too many were waiting (max_waiting)
  size_t bytes = 0;     // currently held, including the finished depth in the map
};

}  // namespace alidade
