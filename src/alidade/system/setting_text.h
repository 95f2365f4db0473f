// Values of settings as text, and back.
#pragma once

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <type_traits>

#include "alidade/base/error.h"
#include "alidade/io/text.h"

namespace alidade {

// Throws Error (usage) for what is no such value; `name` is the setting's.
template <typename Value>
Value ParseSetting(const std::string& name, const std::string& text) {
  if constexpr (std::is_same_v<Value, std::string>) {
    return text;
  } else {
    constexpr bool kWhole = std::is_integral_v<Value>;
    double number = ParseNumber(text).value_or(std::nan(""));
    if constexpr (!kWhole) number = static_cast<Value>(number);  // beyond a float: infinite
    if (!std::isfinite(number) || (kWhole && number != std::floor(number))) {
      ThrowUsage("setting " + name + ": '" + text + "' is not " +
                 (kWhole ? "a whole number" : "a number"));
    }
    if (kWhole && (number < (std::is_unsigned_v<Value> ? 0.0 : -2147483648.0) ||
                   number > (std::is_unsigned_v<Value> ? 9e15 : 2147483647.0))) {
      ThrowUsage("setting " + name + ": " + text + " is out of range");
    }
    return static_cast<Value>(number);
  }
}

template <typename Value>
std::string FormatSetting(const Value& value) {
  std::ostringstream out;
  if constexpr (std::is_same_v<Value, float>) {  // as it is written: 0.3, not 0.3000000119
    std::string text;
    for (int digits = 6; digits <= 9; ++digits) {
      out.str("");
      out.precision(digits);
      out << value;
      text = out.str();
      if (std::strtof(text.c_str(), nullptr) == value) break;
    }
    return text;
  } else {
    out.precision(10);
    out << value;
    return out.str();
  }
}

}  // namespace alidade
