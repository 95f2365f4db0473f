#include "alidade/features/guided_search.h"

namespace alidade {

int PredictLevel(double max_distance, double distance) {
  for (int level = 0; level < kPyramidLevels - 1; ++level) {
    if (distance * ScaleOfLevel(level) >= max_distance) return level;
  }
  return kPyramidLevels - 1;
}

}  // namespace alidade
