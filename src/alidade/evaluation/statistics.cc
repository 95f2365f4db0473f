#include "alidade/evaluation/statistics.h"

#include <algorithm>
#include <cmath>

namespace alidade {

ErrorStatistics DescribeErrors(std::vector<double> errors) {
  ErrorStatistics result;
  result.n = static_cast<int>(errors.size());
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  double sum = 0, sum_squares = 0;
  for (const double e : errors) {
    sum += e;
    sum_squares += e * e;
  }
  result.mean = sum / result.n;
  result.rmse = std::sqrt(sum_squares / result.n);
  double spread = 0;  // about the mean, in a second pass: rmse² - mean² would cancel
  for (const double e : errors) spread += (e - result.mean) * (e - result.mean);
  result.std = std::sqrt(spread / result.n);
  const size_t middle = errors.size() / 2;
  result.median =
      errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  result.min = errors.front();
  result.max = errors.back();
  return result;
}

}  // namespace alidade
