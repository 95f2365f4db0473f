// Which pose of the estimate is compared with which pose of the truth: by their time stamps.
#pragma once

#include <span>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

enum class Association {
  kTum,  // one-to-one, the closest pair of all first (the TUM benchmark's associate tool);
         // difference < max_dt
  kEvo,  // each stamp of the shorter list takes the nearest of the longer, which may be taken
         // twice; <= max_dt
};

struct StampPair {
  int truth = 0;     // index into the truth's stamps
  int estimate = 0;  // index into the estimate's
};

// Both lists ascending (equal neighbours are allowed), seconds. Pairs in the order of the
// estimate's stamps; ties go to the earlier stamp.
std::vector<StampPair> AssociateStamps(std::span<const double> truth,
                                       std::span<const double> estimate, double max_dt,
                                       Association association);

// Index of the stamp closest to `time` in an ascending list that is not empty; ties go to the
// earlier one.
int NearestStamp(std::span<const double> stamps, double time);

}  // namespace alidade
