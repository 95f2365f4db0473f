#include "alidade/io/stamp_unit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

constexpr double kUsualPeriod = 1.0 / 30;  // seconds
// Standard deviation of its decimal logarithm: slow recordings are less rare than fast cameras.
constexpr double kSlowerDecades = 0.75, kFasterDecades = 0.5;
constexpr double kLastTime = 4.1e9;  // seconds; the year 2100
constexpr double kDeclaredOdds = 100;

int Digits(StampUnit unit) { return 3 * static_cast<int>(unit); }

}  // namespace

double PerSecond(StampUnit unit) { return std::pow(10, Digits(unit)); }

const char* NameOf(StampUnit unit) {
  constexpr const char* kNames[] = {"seconds", "milliseconds", "microseconds", "nanoseconds"};
  return kNames[static_cast<int>(unit)];
}

bool CanBe(StampUnit unit, std::span<const double> stamps) {
  return std::none_of(stamps.begin(), stamps.end(), [&](double stamp) {
    return std::isfinite(stamp) && std::abs(stamp) / PerSecond(unit) > kLastTime;
  });
}

std::optional<double> MedianStep(std::span<const double> stamps) {
  std::vector<double> sorted;
  for (const double stamp : stamps) {
    if (std::isfinite(stamp)) sorted.push_back(stamp);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> steps;
  for (size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i] > sorted[i - 1]) steps.push_back(sorted[i] - sorted[i - 1]);
  }
  if (steps.empty()) return std::nullopt;
  return UpperMedian(steps);
}

StampUnit ProbableUnit(std::span<const double> stamps, StampUnit declared) {
  const std::optional<double> step = MedianStep(stamps);
  if (!step) return declared;
  std::optional<double> best;
  StampUnit unit = declared;
  for (const StampUnit candidate : {StampUnit::kSeconds, StampUnit::kMilliseconds,
                                    StampUnit::kMicroseconds, StampUnit::kNanoseconds}) {
    if (!CanBe(candidate, stamps)) continue;
    const double decades = std::log10(*step / PerSecond(candidate) / kUsualPeriod);
    const double sigma = decades > 0 ? kSlowerDecades : kFasterDecades;
    const double score =
        -0.5 * std::pow(decades / sigma, 2) + (candidate == declared ? std::log(kDeclaredOdds) : 0);
    if (!best || score > *best) {
      best = score;
      unit = candidate;
    }
  }
  return unit;
}

std::string StampInSeconds(std::string_view text, StampUnit unit) {
  const auto shift = static_cast<size_t>(Digits(unit));
  if (shift == 0) return std::string(text);
  const size_t point = std::min(text.find('.'), text.size());
  std::string digits(text.substr(0, point));
  std::string rest(text.substr(std::min(point + 1, text.size())));
  const bool negative = !digits.empty() && digits[0] == '-';
  if (negative) digits.erase(0, 1);
  if (digits.empty() || (digits + rest).find_first_not_of("0123456789") != std::string::npos) {
    // 1.4e18 and the like: through a number.
    const auto number = ParseNumber(text);
    if (!number || !std::isfinite(*number)) return std::string(text);
    char buffer[64];
    const long long nano = std::llround(*number / PerSecond(unit) * 1e9);
    std::snprintf(buffer, sizeof(buffer), "%lld.%09lld", nano / 1'000'000'000,
                  std::abs(nano) % 1'000'000'000);
    return buffer;
  }
  if (digits.size() <= shift) digits.insert(0, shift + 1 - digits.size(), '0');
  return (negative ? "-" : "") + digits.insert(digits.size() - shift, 1, '.') + rest;
}

}  // namespace alidade
