// The interface of the core for web pages, tested natively.
#include "alidade/phone/phone_slam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "alidade/stream/stream_scene.h"
#include "support/expect_error.h"
#include "support/walked_room.h"

namespace alidade::phone_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

PhoneFrame Walk(PhoneSlam& slam, const WalkedRoom& room, std::vector<std::string>* messages) {
  PhoneFrame last;
  for (size_t i = 0; i < room.frames.size(); ++i) {
    last = slam.Track(static_cast<double>(i) / 30, room.frames[i].image.data, 1);
    if (!messages) continue;
    for (std::string& message : slam.TakeMessages()) messages->push_back(std::move(message));
  }
  return last;
}

TEST(PhoneSlam, TellsWhereTheCameraIsAndWhatItSees) {
  const WalkedRoom room = WalkRoom({.actors = 0, .frames = 90});
  PhoneSlam slam(room.camera, PhoneSettings::Default(false));
  std::vector<std::string> messages = slam.TakeMessages();
  ASSERT_EQ(messages.size(), 1);  // hello
  const PhoneFrame last = Walk(slam, room, &messages);
  EXPECT_EQ(last.result.state, TrackState::kTracking);
  EXPECT_GT(last.keyframes, 2);
  EXPECT_GT(last.landmarks, 100);
  EXPECT_GT(last.matches, 30);
  EXPECT_EQ(last.fov_sigma, 0);  // the field of view was given
  slam.Finish();
  EXPECT_THAT(slam.Cloud(), StartsWith("ply\nformat binary_little_endian"));
  const std::string trajectory = slam.Trajectory();
  EXPECT_GT(std::count(trajectory.begin(), trajectory.end(), '\n'), 60);
  // A receiver of all messages and one that joins at the end have the same state.
  StreamScene told, joined;
  for (const std::string& message : slam.TakeMessages()) messages.push_back(message);
  for (const std::string& message : messages) told.Take(message);
  ASSERT_GE(told.now.ms.size(), 3);
  EXPECT_GT(told.now.ms[0], 0);  // frame
  EXPECT_GT(told.now.ms[2], 0);  // track; the last frame may need no features, which ms[1] is of
  for (const std::string& message : slam.WholeState()) joined.Take(message);
  EXPECT_EQ(told.keyframes.size(), joined.keyframes.size());
  EXPECT_EQ(told.landmarks.size(), joined.landmarks.size());
  EXPECT_EQ(static_cast<int>(told.keyframes.size()), slam.slam().Snapshot().keyframe_count());
}

TEST(PhoneSlam, AnUnknownCameraIsAssumedAndSaidToBe) {
  const WalkedRoom room = WalkRoom({.actors = 0, .frames = 3});
  PhoneSlam slam(room.camera.width, room.camera.height, 0, PhoneSettings::Default(false));
  const PhoneFrame last = Walk(slam, room, nullptr);
  EXPECT_NEAR(last.fov, 66, 0.1);
  EXPECT_GT(last.fov_sigma, 10);
  PhoneSlam upright(300, 400, 0, PhoneSettings::Default(false));
  const std::vector<uint8_t> grey(300 * 400, 90);
  EXPECT_NEAR(upright.Track(0, grey.data(), 1).fov, 52, 1);  // 66 along the longer side
}

// Number of features of the last image in its middle, and of excluded ones.
struct LeftOut {
  int inside = 0, left_out = 0, elsewhere_left_out = 0;
};

// Reports for every tenth image that a person fills the middle third, twelve images late.
LeftOut WalkPast(PhoneSlam& slam, const WalkedRoom& room, bool person) {
  const cv::Rect2f middle(110, 60, 100, 140);
  for (int i = 0; i < static_cast<int>(room.frames.size()); ++i) {
    const PhoneFrame frame =
        slam.Track(i / 30.0, room.frames[static_cast<size_t>(i)].image.data, 1);
    EXPECT_EQ(frame.number, i);
    if (i >= 12 && i % 10 == 2)
      slam.Detected(i - 12,
                    person ? std::vector<Detection>{{0, 0.9f, middle}} : std::vector<Detection>{});
  }
  LeftOut counts;
  for (const FeatureUse& use : slam.slam().Features()) {
    const bool inside = std::abs(use.x - 160) < 25 && std::abs(use.y - 130) < 35;
    const bool out = use.static_probability < 0.5f;
    counts.inside += inside;
    counts.left_out += inside && out;
    counts.elsewhere_left_out += !inside && out && !middle.contains({use.x, use.y});
  }
  return counts;
}

TEST(PhoneSlam, WhatADetectorFindsIsLeftOutHoweverLateItAnswers) {
  const WalkedRoom room = WalkRoom({.actors = 0, .frames = 60});
  PhoneSettings settings = PhoneSettings::Default(false);
  settings.detector_classes = {"person", "chair"};
  PhoneSlam with(room.camera, settings), without(room.camera, settings);
  const LeftOut person = WalkPast(with, room, true), nobody = WalkPast(without, room, false);
  // Features are extracted elsewhere; the existing ones are excluded.
  EXPECT_GT(nobody.inside, 10);
  EXPECT_LT(nobody.left_out, 0.2 * nobody.inside);
  EXPECT_LT(person.inside - person.left_out, 0.2 * nobody.inside);
  EXPECT_LT(person.elsewhere_left_out, 50);
  const auto seen = with.slam().Detections();
  ASSERT_TRUE(seen.has_value());
  EXPECT_EQ(seen->names, std::vector<std::string>{"person"});
  EXPECT_GE(seen->frames_ago, 12);
  EXPECT_FALSE(with.slam().MoverMask().empty());
}

TEST(PhoneSlam, DetectionsThatCannotBeAreRefusedAndThoseWithoutADetectorIgnored) {
  const std::vector<uint8_t> grey(64 * 48, 90);
  PhoneSettings settings = PhoneSettings::Default(false);
  PhoneSlam none(64, 48, 60, settings);
  none.Track(0, grey.data(), 1);
  none.Detected(0, {{7, 1, {0, 0, 9, 9}}});
  settings.detector_classes = {"person"};
  PhoneSlam slam(64, 48, 60, settings);
  slam.Track(0, grey.data(), 1);
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          slam.Detected(0, {{7, 1, {0, 0, 9, 9}}});
                        }),
              HasSubstr("class 7 of 1"));
  slam.Detected(99, {{0, 1, {0, 0, 9, 9}}});  // a future image
  slam.Track(0.1, grey.data(), 1);
  EXPECT_FALSE(slam.slam().Detections().has_value());
}

TEST(PhoneSlam, ColoursAreTurnedToGrey) {
  PhoneSlam slam(64, 48, 60, PhoneSettings::Default(false));
  const std::vector<uint8_t> pixels(size_t{64} * 48 * 4, 90);
  EXPECT_EQ(slam.Track(0, pixels.data(), 4).result.state, TrackState::kInitializing);
}

TEST(PhoneSettings, AreSetByLines) {
  PhoneSettings settings = PhoneSettings::Default(false);
  settings.SetLines("tracker.extractor.features=300\n\nsemidense.enabled=1");
  EXPECT_EQ(settings.slam.tracker.extractor.features, 300);
  EXPECT_TRUE(settings.slam.semidense.enabled);
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { settings.SetLines("tracker.no_such=1"); }),
              HasSubstr("tracker.no_such"));
}

TEST(PhoneSlam, WhatCannotBeIsRefused) {
  const PhoneSettings settings = PhoneSettings::Default(false);
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { PhoneSlam(64, 48, 200, settings); }),
              HasSubstr("field of view"));
  PhoneSlam slam(64, 48, 60, settings);
  const std::vector<uint8_t> grey(64 * 48, 90);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { slam.Track(NAN, grey.data(), 1); }),
              HasSubstr("time"));
}

}  // namespace
}  // namespace alidade::phone_test
