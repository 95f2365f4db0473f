// Associates poses of the estimate with poses of the ground truth by time.
#pragma once

#include <span>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

enum class Association {
  // One-to-one, closest pairs first, difference < max_dt (the TUM benchmark's associate tool).
  kTum,
  // Each stamp of the shorter list gets the nearest of the longer one, which may be used twice;
  // difference <= max_dt.
  kEvo,
};

struct StampPair {
  int truth = 0;     // index into the ground truth's stamps
  int estimate = 0;  // index into the estimate's stamps
};

// Both lists in seconds and ascending (equal stamps are allowed). Pairs are in the order of the
// estimate's stamps; ties go to the earlier stamp.
std::vector<StampPair> AssociateStamps(std::span<const double> truth,
                                       std::span<const double> estimate, double max_dt,
                                       Association association);

// Index of the stamp nearest to `time` in a non-empty ascending list; ties go to the earlier stamp.
int NearestStamp(std::span<const double> stamps, double time);

}  // namespace alidade
