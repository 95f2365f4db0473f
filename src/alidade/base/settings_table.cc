#include "alidade/base/settings_table.h"

#include <cstdlib>
#include <cstring>
#include <locale>
#include <optional>
#include <sstream>

#include "alidade/base/error.h"

namespace alidade {
namespace {

template <typename Value>
const Value& ValueAt(const Setting& row, const void* settings) {
  return *static_cast<const Value*>(row.field(const_cast<void*>(settings)));
}

std::string Digits(double value, int digits) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(digits);
  out << value;
  return out.str();
}

std::string ShortestFloat(float value) {
  std::string text;
  for (int digits = 6; digits <= 9; ++digits) {
    text = Digits(value, digits);
    std::istringstream in(text);  // not strtof(), which depends on the program's locale
    in.imbue(std::locale::classic());
    float back = 0;
    if (in >> back && back == value) break;
  }
  return text;
}

std::optional<double> NumberAt(const Setting& row, const void* settings) {
  switch (row.type) {
    case SettingType::kInt:
      return ValueAt<int>(row, settings);
    case SettingType::kUint64:
      return static_cast<double>(ValueAt<uint64_t>(row, settings));
    case SettingType::kFloat:
      return ValueAt<float>(row, settings);
    case SettingType::kDouble:
      return ValueAt<double>(row, settings);
    default:
      return {};
  }
}

bool IsWithin(const SettingRange& range, double value) {
  if (range.or_zero && value == 0) return true;
  return (range.open_min ? value > range.min : value >= range.min) &&
         (range.open_max ? value < range.max : value <= range.max);
}

}  // namespace

std::string FullName(const Setting& row) {
  return std::string(row.expert ? "expert." : "") + row.name;
}

std::string FormatValue(const Setting& row, const void* settings) {
  switch (row.type) {
    case SettingType::kBool:
      return ValueAt<bool>(row, settings) ? "1" : "0";
    case SettingType::kInt:
      return std::to_string(ValueAt<int>(row, settings));
    case SettingType::kUint64:
      return std::to_string(ValueAt<uint64_t>(row, settings));
    case SettingType::kFloat:
      return ShortestFloat(ValueAt<float>(row, settings));
    case SettingType::kDouble:
      return Digits(ValueAt<double>(row, settings), 10);
    case SettingType::kText:
      return ValueAt<std::string>(row, settings);
    case SettingType::kWord:
      break;
  }
  int value = 0;
  std::memcpy(&value, row.field(const_cast<void*>(settings)), sizeof(value));
  return row.words[value];
}

std::string RangeInWords(const SettingRange& range) {
  const bool min = range.min > -std::numeric_limits<double>::infinity();
  const bool max = range.max < std::numeric_limits<double>::infinity();
  const std::string low = Digits(range.min, 10), high = Digits(range.max, 10);
  std::string text = range.or_zero ? "0 or " : "";
  if (min && max && !range.open_min && !range.open_max) return text + "from " + low + " to " + high;
  if (min) text += (range.open_min ? "above " : "at least ") + low;
  if (min && max) text += " and ";
  if (max) text += (range.open_max ? "below " : "at most ") + high;
  return text;
}

void CheckRange(const Setting& row, const void* settings) {
  const std::optional<double> value = NumberAt(row, settings);
  if (!value || IsWithin(row.range, *value)) return;
  const std::string range = RangeInWords(row.range);  // "": only NaN is excluded
  ThrowUsage("setting " + FullName(row) + " must be " + (range.empty() ? "a number" : range) +
             ", not " + FormatValue(row, settings));
}

}  // namespace alidade
