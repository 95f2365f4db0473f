// Names of modes, and invalid settings.
#include "alidade/dynamics/settings.h"

#include <cmath>
#include <functional>
#include <utility>

#include "support/expect_error.h"

namespace alidade::settings_test {
namespace {

using testing::HasSubstr;

TEST(DynamicsMode, HasANameThatIsReadBack) {
  for (DynamicsMode mode :
       {DynamicsMode::kOff, DynamicsMode::kAuto, DynamicsMode::kGeometry, DynamicsMode::kFull})
    EXPECT_EQ(DynamicsModeNamed("--dynamics", NameOf(mode)), mode);
}

TEST(DynamicsMode, AWordThatNamesNoneIsToldWithThoseThereAre) {
  const std::string message =
      MessageOf(ErrorKind::kUsage, [] { DynamicsModeNamed("--dynamics", "geometri"); });
  for (const char* part : {"--dynamics", "geometri", "off", "auto", "geometry", "full"})
    EXPECT_THAT(message, HasSubstr(part));
  EXPECT_THAT(message, HasSubstr("did you mean"));
  for (const char* word : {"", "Off", "on"})
    MessageOf(ErrorKind::kUsage, [&] { DynamicsModeNamed("--dynamics", word); });
}

TEST(DynamicsSettings, AreFineAsTheyCome) { EXPECT_EQ(ComplaintAbout(DynamicsSettings()), ""); }

TEST(DynamicsSettings, WhatCannotBeIsNamed) {
  using Change = std::function<void(DynamicsSettings&)>;
  const double nan = std::nan("");
  const std::vector<std::pair<const char*, Change>> cases = {
      {"detector_every_frames", [](auto& s) { s.detector_every_frames = 0; }},
      {"detector_latency_frames", [](auto& s) { s.detector_latency_frames = -1; }},
      {"detector_latency_frames", [](auto& s) { s.detector_latency_frames = 1000; }},
      {"detector_rest", [](auto& s) { s.detector_rest = -0.1; }},
      {"detector_rest", [=](auto& s) { s.detector_rest = nan; }},
      {"drop_detections", [](auto& s) { s.drop_detections = 1.1; }},
      {"drop_detections", [=](auto& s) { s.drop_detections = nan; }},
      {"bridge_seconds", [](auto& s) { s.bridge_seconds = -1; }},
      {"bridge_seconds", [=](auto& s) { s.bridge_seconds = nan; }},
      {"watch_frames", [](auto& s) { s.watch_frames = s.votes.agreement_ago; }},
      {"watch_every", [](auto& s) { s.watch_every = s.watch_frames - 1; }},
      {"watch_mean", [](auto& s) { s.watch_mean = 0; }},
      {"watch_moved", [](auto& s) { s.watch_moved = 0; }},
      {"watch_moved", [=](auto& s) { s.watch_moved_depth = nan; }},
      {"watch_lens", [](auto& s) { s.watch_lens = -1; }},
      {"watch_rival_frames", [](auto& s) { s.watch_rival_frames = 0; }},
      {"min_score", [](auto& s) { s.detector.min_score = 2; }},
  };
  for (const auto& [name, change] : cases) {
    DynamicsSettings settings;
    change(settings);
    EXPECT_THAT(ComplaintAbout(settings), HasSubstr(name));
  }
}

TEST(DynamicsSettings, TheLatencyCanBeStudiedUpToTenFramesAndMore) {
  for (int late : {0, 1, 3, 6, 10}) {
    DynamicsSettings settings;
    settings.detector_latency_frames = late;
    EXPECT_EQ(ComplaintAbout(settings), "");
  }
}

}  // namespace
}  // namespace alidade::settings_test
