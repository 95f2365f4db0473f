// Summary statistics of a list of errors.
#pragma once

#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// In the unit of the errors. `std` divides by n (ddof 0); the median of an even number is the mean
// of the middle two.
struct ErrorStatistics {
  int n = 0;
  double rmse = 0, mean = 0, median = 0, std = 0, min = 0, max = 0;
};

ErrorStatistics DescribeErrors(std::vector<double> errors);  // all zero for an empty list

}  // namespace alidade
