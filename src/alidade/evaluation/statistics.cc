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
  // Sum of squared deviations, in a second pass, because rmse² - mean² suffers from cancellation.
  double spread = 0;
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
