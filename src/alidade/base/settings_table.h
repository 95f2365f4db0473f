// Tables of settings. A row gives the field's name, range, unit and meaning; parsing by name, range
// checks, `alidade settings` and docs/reference/settings.md all come from the rows.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// The values a setting may have. NaN is never one of them.
struct SettingRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false, open_max = false;  // the end itself is excluded
  bool or_zero = false;                     // 0 is allowed as well
};

constexpr SettingRange AtLeast(double min) { return {.min = min}; }
constexpr SettingRange MoreThan(double min) { return {.min = min, .open_min = true}; }
constexpr SettingRange FromTo(double min, double max) { return {.min = min, .max = max}; }
constexpr SettingRange ZeroOr(SettingRange range) {
  range.or_zero = true;
  return range;
}
inline constexpr SettingRange kAnyText{};  // of words and texts
inline constexpr SettingRange kOnOff{};    // of bool
inline constexpr SettingRange kPositive = MoreThan(0);
inline constexpr SettingRange kNotNegative = AtLeast(0);
inline constexpr SettingRange kZeroToOne = FromTo(0, 1);
inline constexpr SettingRange kShareBelowOne{.min = 0, .max = 1, .open_max = true};
inline constexpr SettingRange kPositiveShare{.min = 0, .max = 1, .open_min = true};

enum class SettingType : uint8_t { kBool, kInt, kUint64, kFloat, kDouble, kText, kWord };

// One row. Units and meanings are for people and are not compiled into alidade.wasm, whose size is
// limited.
struct Setting {
  const char* name;                // without the "expert." of expert settings
  void* (*field)(void* settings);  // `settings`: the struct that the table belongs to
  SettingRange range;
  const char* const* words;  // kWord: the word of each value, then null
  SettingType type;
  bool expert;  // false: public, i.e. stable and documented
#ifndef __EMSCRIPTEN__
  const char* unit;     // "" when there is none
  const char* meaning;  // one sentence; "" in all but one of the rows that share a name
#endif
};

namespace settings_table {

template <typename Struct, typename Field>
Struct StructOf(Field Struct::*);

// The field reached by `First`, then each of `Rest`.
template <auto First, auto... Rest>
void* FieldAt(void* settings) {
  auto& field = static_cast<decltype(StructOf(First))*>(settings)->*First;
  if constexpr (sizeof...(Rest) == 0) {
    return &field;
  } else {
    return FieldAt<Rest...>(&field);
  }
}

template <auto First, auto... Rest>
constexpr auto TypeOfField() {
  if constexpr (sizeof...(Rest) == 0) {
    using Struct = decltype(StructOf(First));
    return std::type_identity<std::remove_reference_t<decltype(std::declval<Struct&>().*First)>>();
  } else {
    return TypeOfField<Rest...>();
  }
}

template <typename Value>
constexpr SettingType TypeOf() {
  if constexpr (std::is_same_v<Value, bool>) return SettingType::kBool;
  if constexpr (std::is_same_v<Value, int>) return SettingType::kInt;
  if constexpr (std::is_same_v<Value, uint64_t>) return SettingType::kUint64;
  if constexpr (std::is_same_v<Value, float>) return SettingType::kFloat;
  if constexpr (std::is_same_v<Value, double>) return SettingType::kDouble;
  if constexpr (std::is_same_v<Value, std::string>) return SettingType::kText;
  if constexpr (std::is_enum_v<Value>) {
    static_assert(std::is_same_v<std::underlying_type_t<Value>, int>);
    return SettingType::kWord;
  }
}

template <auto... Path>
constexpr Setting Row(bool expert, const char* name, const SettingRange& range,
                      const char* const* words, [[maybe_unused]] const char* unit,
                      [[maybe_unused]] const char* meaning) {
  using Value = typename decltype(TypeOfField<Path...>())::type;
  return {name, FieldAt<Path...>, range, words, TypeOf<Value>(), expert,
#ifndef __EMSCRIPTEN__
          unit, meaning
#endif
  };
}

}  // namespace settings_table

// Rows. `Path`: pointers to members that lead from the struct to the field, usually just one.
template <auto... Path>
constexpr Setting PublicSetting(const char* name, const SettingRange& range, const char* unit,
                                const char* meaning) {
  return settings_table::Row<Path...>(false, name, range, nullptr, unit, meaning);
}
template <auto... Path>
constexpr Setting ExpertSetting(const char* name, const SettingRange& range, const char* unit,
                                const char* meaning) {
  return settings_table::Row<Path...>(true, name, range, nullptr, unit, meaning);
}
// A field that has the same quantity as one of another table: both are set by its name.
template <auto... Path>
constexpr Setting SameSetting(const char* name, const SettingRange& range) {
  return settings_table::Row<Path...>(true, name, range, nullptr, "", "");
}
// A field with a fixed set of words; `words` is indexed by the enum's value and ends with null.
template <auto... Path>
constexpr Setting PublicChoice(const char* name, const char* const* words, const char* meaning) {
  return settings_table::Row<Path...>(false, name, {}, words, "", meaning);
}

// The name after --set: "expert." and the row's name, or the row's name alone.
std::string FullName(const Setting& row);
// The field's value: 0.3, 1 (true), off. Floats have as few digits as give the same value again.
std::string FormatValue(const Setting& row, const void* settings);
// "at least 6", "above 0 and at most 4", "0 or at least 100"; "" when every value will do.
std::string RangeInWords(const SettingRange& range);
// Throws Error (usage) naming the setting, its value and its range.
void CheckRange(const Setting& row, const void* settings);

// A struct and its table.
struct SettingsPart {
  void* settings;
  std::span<const Setting> table;
};
template <typename Settings>
SettingsPart PartOf(Settings& settings) {
  return {&settings, Settings::Table()};
}

// Checks the ranges of one struct.
template <typename Settings>
void CheckRanges(const Settings& settings) {
  for (const Setting& row : Settings::Table()) CheckRange(row, &settings);
}

}  // namespace alidade
