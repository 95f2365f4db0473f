#include "alidade/run/recorder/stream_settings.h"

#include "alidade/run/setup/setting_group.h"

namespace alidade {
namespace {

// `s` is a StreamFeedSettings, const or not.
constexpr auto kVisit = [](auto& s, auto&& visit) {
  visit("stream.depth_points", s.stream.depth_points);
  visit("stream.detection_seconds", s.stream.detection_seconds);
  visit("stream.edge_shared", s.stream.edge_shared);
  visit("stream.landmark_tolerance", s.stream.landmark_tolerance);
  visit("stream.mcap_rate", s.mcap_rate);
  visit("stream.mcap_seconds", s.mcap_seconds);
  visit("stream.outline_tolerance", s.stream.outline_tolerance);
  visit("stream.path_frames", s.stream.path_frames);
  visit("stream.picture_quality", s.picture_quality);
  visit("stream.picture_width", s.picture_width);
  visit("stream.pictures_hz", s.pictures_hz);
  visit("stream.waiting", s.waiting);
  visit("stream.whole_seconds", s.whole_seconds);
};

}  // namespace

void StreamFeedSettings::Check() const {
  stream.Check();
  const auto check = [](bool good, const char* name, const char* range) {
    if (!good) ThrowUsage("stream." + std::string(name) + " must be " + range);
  };
  check(picture_width >= 16 && picture_width <= 8192, "picture_width", "within 16…8192");
  check(picture_quality >= 1 && picture_quality <= 100, "picture_quality", "within 1…100");
  check(pictures_hz >= 0, "pictures_hz", "at least 0");
  check(whole_seconds > 0, "whole_seconds", "above 0");
  check(mcap_seconds >= 0, "mcap_seconds", "at least 0");
  check(mcap_rate > 0, "mcap_rate", "above 0");
  check(waiting >= 1, "waiting", "at least 1");
}

void StreamFeedSettings::Set(const std::string& name, const std::string& value) {
  SetByName(*this, kVisit, name, value);
}

std::vector<std::pair<std::string, std::string>> StreamFeedSettings::All() const {
  return AllByName(*this, kVisit);
}

}  // namespace alidade
