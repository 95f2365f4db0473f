#include "alidade/system/settings.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <type_traits>

#include "alidade/base/error.h"
#include "alidade/base/nearest_name.h"

namespace alidade {
namespace {

// The list of fields, once: read, written and named from here.
template <typename Settings, typename Visit>
void VisitFields(Settings& s, Visit&& visit) {
  visit("image_width", s.image_width);
  visit("seed", s.seed);
  auto& t = s.tracker;
  visit("tracker.extractor.features", t.extractor.features);
  visit("tracker.extractor.fast_threshold", t.extractor.fast_threshold);
  visit("tracker.extractor.fast_minimum", t.extractor.fast_minimum);
  visit("tracker.extractor.cell", t.extractor.cell);
  visit("tracker.match_scale", t.match_scale);
  visit("tracker.min_predicted", t.min_predicted);
  visit("tracker.min_after_prediction", t.min_after_prediction);
  visit("tracker.min_tracked", t.min_tracked);
  visit("tracker.min_agreement", t.min_agreement);
  visit("tracker.good_agreement", t.good_agreement);
  visit("tracker.bad_frame_sigma", t.bad_frame_sigma);
  visit("tracker.max_distance", t.max_distance);
  visit("tracker.local_ratio", t.local_ratio);
  visit("tracker.last_frame_radius", t.last_frame_radius);
  visit("tracker.last_frame_radius_depth", t.last_frame_radius_depth);
  visit("tracker.local_radius", t.local_radius);
  visit("tracker.local_radius_depth", t.local_radius_depth);
  visit("tracker.local_keyframes", t.local_keyframes);
  visit("tracker.sigma_px", t.noise.sigma_px);
  visit("tracker.sigma_right_px", t.noise.sigma_right_px);
  visit("tracker.keyframe_share_mono", t.keyframe_share_mono);
  visit("tracker.keyframe_share_depth", t.keyframe_share_depth);
  visit("tracker.keyframe_min_gap", t.keyframe_min_gap);
  visit("tracker.keyframe_max_gap", t.keyframe_max_gap);
  auto& m = s.mapper;
  visit("mapper.sigma_px", m.noise.sigma_px);
  visit("mapper.sigma_right_px", m.noise.sigma_right_px);
  visit("mapper.match_scale", m.match_scale);
  visit("mapper.max_depth", m.max_depth);
  visit("mapper.triangulate_keyframes_mono", m.triangulate_keyframes_mono);
  visit("mapper.triangulate_keyframes_depth", m.triangulate_keyframes_depth);
  visit("mapper.triangulate_distance", m.triangulate_distance);
  visit("mapper.triangulate_ratio", m.triangulate_ratio);
  visit("mapper.min_parallax_degrees", m.min_parallax_degrees);
  visit("mapper.min_baseline_ratio", m.min_baseline_ratio);
  visit("mapper.fuse_keyframes", m.fuse_keyframes);
  visit("mapper.fuse_radius", m.fuse_radius);
  visit("mapper.fuse_distance", m.fuse_distance);
  visit("mapper.min_found_share", m.min_found_share);
  visit("mapper.trial_keyframes", m.trial_keyframes);
  visit("mapper.redundant_share", m.redundant_share);
  visit("mapper.window_keyframes", m.window_keyframes);
  visit("mapper.window_fixed", m.window_fixed);
  visit("mapper.bundle.max_iterations", m.bundle.max_iterations);
  visit("mapper.bundle.min_relative_decrease", m.bundle.min_relative_decrease);
  auto& i = s.start;
  visit("start.min_matches", i.min_matches);
  visit("start.match_scale", i.match_scale);
  visit("start.references", i.references);
  visit("start.reference_gap", i.reference_gap);
  visit("start.window", i.window);
  visit("start.min_motion", i.min_motion);
  visit("start.trial_frames", i.trial_frames);
  visit("start.trial_share", i.trial_share);
  visit("start.iterations", i.two_view.iterations);
  visit("start.sigma", i.two_view.sigma);
  visit("start.homography_share", i.two_view.homography_share);
  visit("start.min_parallax_degrees", i.two_view.min_parallax_degrees);
  visit("start.min_triangulated", i.two_view.min_triangulated);
}

template <typename Value>
Value Parse(const std::string& name, const std::string& text) {
  char* end = nullptr;
  double number = std::strtod(text.c_str(), &end);
  const bool whole = std::is_integral_v<Value>;
  if (text.empty() || *end != '\0' || !std::isfinite(number) ||
      (whole && number != std::floor(number))) {
    ThrowUsage("setting " + name + ": '" + text + "' is not " +
               (whole ? "a whole number" : "a number"));
  }
  if (whole && (number < (std::is_unsigned_v<Value> ? 0.0 : -2147483648.0) ||
                number > (std::is_unsigned_v<Value> ? 9e15 : 2147483647.0))) {
    ThrowUsage("setting " + name + ": " + text + " is out of range");
  }
  return static_cast<Value>(number);
}

template <typename Value>
std::string Format(Value value) {
  std::ostringstream out;
  out.precision(10);
  out << value;
  return out.str();
}

}  // namespace

void SlamSettings::Set(const std::string& name, const std::string& value) {
  bool known = false;
  std::vector<std::string> names;
  VisitFields(*this, [&](const char* field, auto& member) {
    names.push_back(field);
    if (name != field) return;
    known = true;
    member = Parse<std::decay_t<decltype(member)>>(name, value);
  });
  if (!known) ThrowUsage("unknown setting '" + name + "'" + DidYouMean(name, names));
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
  tracker.match_scale = mapper.match_scale = start.match_scale = 0.8;
}

void SlamSettings::Check() const {
  if (image_width != 0 && image_width < 100)
    ThrowUsage("image_width must be 0 or at least 100 pixels");
  tracker.Check();
  mapper.Check();
  start.Check();
}

}  // namespace alidade
