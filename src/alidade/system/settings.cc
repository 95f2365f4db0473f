#include "alidade/system/settings.h"

#include <algorithm>
#include <type_traits>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"
#include "alidade/system/setting_text.h"
#include "alidade/system/settings_fields.h"

namespace alidade {
namespace {

template <typename Value>
Value Parse(const std::string& name, const std::string& text) {
  if constexpr (std::is_same_v<Value, DynamicsMode>) {
    return DynamicsModeNamed("setting " + name, text);
  } else {
    return ParseSetting<Value>(name, text);
  }
}

template <typename Value>
std::string Format(const Value& value) {
  if constexpr (std::is_same_v<Value, DynamicsMode>) {
    return NameOf(value);
  } else {
    return FormatSetting(value);
  }
}

}  // namespace

void SlamSettings::Set(const std::string& name, const std::string& value) {
  bool known = false;
  VisitFields(*this, [&](const char* field, auto& member) {
    if (name != field) return;
    known = true;
    member = Parse<std::decay_t<decltype(member)>>(name, value);
  });
  if (known) return;
  std::vector<std::string> names;
  VisitFields(*this, [&](const char* field, const auto&) { names.push_back(field); });
  ThrowUsage("unknown setting '" + name + "'" + DidYouMean(name, names));
}

std::vector<std::pair<std::string, std::string>> SlamSettings::All() const {
  std::vector<std::pair<std::string, std::string>> all;
  VisitFields(*this, [&](const char* field, const auto& member) {
    all.push_back({field, Format(member)});
  });
  std::sort(all.begin(), all.end());
  return all;
}

void SlamSettings::ApplyProfile(const std::string& profile) {
  if (profile == "desktop") return;
  if (profile != "phone") ThrowUsage("unknown profile '" + profile + "'; known: desktop, phone");
  image_width = 400;
  tracker.extractor.features = 500;
  semidense.keyframes = 5;
  // In a smaller picture edges are steeper: 12 would take the same ones. 16 takes two thirds of
  // them at the same error (kitchen: median 1.9 %), so that a keyframe costs 15 ms (U = 3.6 ms),
  // not 22.
  semidense.min_gradient = 16;
  // A phone's own lens is within 10 % of what is assumed; what was put into the picture stays
  // there.
  refine.begin_anew = 0.1;
  tracker.match_scale = mapper.match_scale = start.match_scale = loop.match_scale = 0.8;
}

void SlamSettings::WaryOfTurns() {
  // Relative uncertainty of an assumed focal length: phones and webcams have 50 to 90 degrees.
  constexpr double kAssumedLens = 0.6;
  double& wary = start.two_view.lens_uncertainty;
  if (wary == 0) wary = kAssumedLens;
}

void SlamSettings::FindCamera() {
  WaryOfTurns();
  readout.enabled = false;
  refine.enabled = true;
}

void TrajectorySettings::Check() const {
  if (!(keep_seconds >= 0)) ThrowUsage("trajectory.keep_seconds must not be negative");
}

void EarlyFrameSettings::Check() const {
  if (most < 0 || settle < 0 || most_missed < 1)
    ThrowUsage("early.most and early.settle must not be negative, early.most_missed not below 1");
  if (!(max_leap > 0)) ThrowUsage("early.max_leap must be positive");
  if (!(min_leap >= 0)) ThrowUsage("early.min_leap must not be negative");
  if (!(leap_seconds > 0)) ThrowUsage("early.leap_seconds must be positive");
}

void SlamSettings::Check() const {
  if (image_width != 0 && image_width < 100)
    ThrowUsage("image_width must be 0 or at least 100 pixels");
  if (max_image_side != 0 && max_image_side < 100)
    ThrowUsage("max_image_side must be 0 or at least 100 pixels");
  tracker.Check();
  mapper.Check();
  loop.Check();
  places.Check();
  semidense.Check();
  dynamics.Check();
  trajectory.Check();
  time.Check();
  if (!(new_map_seconds >= 0) || new_map_frames < 1)
    ThrowUsage("new_map_seconds must not be negative, new_map_frames must be at least 1");
  if (min_map_keyframes < 0) ThrowUsage("min_map_keyframes must not be negative");
  start.Check();
  early.Check();
  readout.Check();
  refine.Check();
  if (refine.enabled && sensor != Sensor::kMono)
    ThrowUsage("refine.enabled is for one camera (mono)");
}

}  // namespace alidade
