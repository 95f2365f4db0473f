#include "alidade/view/histogram.h"

#include <algorithm>
#include <utility>

#include "alidade/base/print.h"
#include "alidade/base/timing.h"
#include "alidade/view/svg.h"

namespace alidade {
namespace {

constexpr double kWide = 440, kTall = 150;  // so that two fit side by side
constexpr double kFloor = 24;               // pixels below the bars, for the numbers
constexpr size_t kBars = 40;
constexpr double kLetter = 9;  // width of a letter, pixels, at most

// The 99th percentile; the axis starts at 0.
double TopOf(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(99 * (values.size() - 1) / 100);
  std::nth_element(values.begin(), at, values.end());
  return std::max(*at, 1e-9);
}

}  // namespace

std::string DrawHistogram(const std::vector<double>& values, const std::string& unit,
                          const std::string& label) {
  std::string svg = OpenSvg(kWide, kTall, label);
  if (values.empty()) return svg + "</svg>\n";
  const double top = TopOf(values), bottom = kTall - kFloor;
  std::vector<size_t> counts(kBars);
  for (const double value : values) {
    const double bar = kBars * std::max(0.0, value) / top;
    ++counts[std::min(kBars - 1, static_cast<size_t>(std::min(bar, 1.0 * kBars)))];
  }
  const auto most = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
  const double wide = kWide / kBars;
  for (size_t i = 0; i < kBars; ++i) {
    if (counts[i] == 0) continue;
    // at least one pixel high, so that single values stay visible
    const double tall = std::max(1.0, (bottom - 4) * static_cast<double>(counts[i]) / most);
    svg += "<rect class=\"bar\" x=\"" + SvgNumber(wide * static_cast<double>(i)) + "\" y=\"" +
           SvgNumber(bottom - tall) + "\" width=\"" + SvgNumber(wide - 1) + "\" height=\"" +
           SvgNumber(tall) + "\"/>\n";
  }
  const auto x = [&](double value) { return kWide * std::clamp(value / top, 0.0, 1.0); };
  const Summary s = Summarise(values);
  for (const auto& [value, name] : {std::pair{s.median, "median"}, std::pair{s.p95, "p95"}}) {
    svg += std::string("<path class=\"") + name + "\" d=\"M" + SvgNumber(x(value)) + " 0V" +
           SvgNumber(bottom) + "\"/>\n";
  }
  svg += "<path class=\"grid\" d=\"M0 " + SvgNumber(bottom) + "H" + SvgNumber(kWide) + "\"/>\n";
  const double step = RoundStep(top / 3);
  double free_from = 0;  // where the label before ends
  for (int i = 0; i * step <= top && i < 9; ++i) {
    char number[40];
    PrintTo(number, sizeof(number), "%g", i * step);
    const std::string text = i == 0 ? number : number + (" " + unit);
    const double letters = kLetter * static_cast<double>(text.size());
    const double from = std::clamp(x(i * step) - letters / 2, 0.0, kWide - letters);
    if (from < free_from) continue;
    svg += SvgText(from + letters / 2, kTall - 6, "middle", text);
    free_from = from + letters + kLetter;
  }
  return svg + "</svg>\n";
}

}  // namespace alidade
