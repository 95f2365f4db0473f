// The unit of a list of time stamps.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace alidade {

enum class StampUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };

double PerSecond(StampUnit unit);    // 1, 1e3, 1e6, 1e9
const char* NameOf(StampUnit unit);  // "seconds", …

// Whether a clock that began in 1970 or later can show `stamps` in this unit before the year 2100.
bool CanBe(StampUnit unit, std::span<const double> stamps);

// Median step between neighbors in order of time, in the unit of `stamps`; nullopt: all are equal.
std::optional<double> MedianStep(std::span<const double> stamps);

// The most probable unit of `stamps`, the times of a camera's images as written, in any order.
// Model: the image period is log-normal about 1/30 s, with a standard deviation of .75 decades
// above and .5 below; the clock can show the stamps (CanBe()); the format's own unit is `declared`,
// which holds in 100 of 101 lists. Two stamps are needed; otherwise the result is `declared`.
StampUnit ProbableUnit(std::span<const double> stamps, StampUnit declared);

// A stamp's text in seconds: "1403715273262142976" (ns) -> "1403715273.262142976",
// "20500.25" (ms) -> "20.50025". Text that is no decimal number is returned unchanged.
std::string StampInSeconds(std::string_view text, StampUnit unit);

}  // namespace alidade
