// A detector whose results are delivered later from elsewhere.
#include "alidade/detect/late_detector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/expect_error.h"

namespace alidade::late_detector_test {
namespace {

using testing::HasSubstr;

TEST(LateDetector, GivesTheNewestAnswerOnce) {
  LateDetector detector({"person", "chair"});
  EXPECT_FALSE(detector.TakeAnswer().has_value());
  detector.Bring({3, {{0, 0.5f, {1, 2, 3, 4}}}});
  detector.Bring({7, {{1, 0.6f, {1, 2, 3, 4}}}});
  detector.Bring({5, {}});  // out of order
  const auto answer = detector.TakeAnswer();
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->number, 7);
  EXPECT_EQ(answer->detections.at(0).class_id, 1);
  EXPECT_FALSE(detector.TakeAnswer().has_value());
  detector.Bring({7, {}});  // delivered twice
  EXPECT_FALSE(detector.TakeAnswer().has_value());
}

TEST(LateDetector, WhatCannotBeIsRefusedAndNothingIsLost) {
  LateDetector detector({"person"});
  detector.Bring({1, {}});
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          detector.Bring({2, {{1, 1, {0, 0, 9, 9}}}});
                        }),
              HasSubstr("class 1 of 1"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          detector.Bring({2, {{0, 1, {NAN, 0, 9, 9}}}});
                        }),
              HasSubstr("impossible numbers"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [&] {
                          detector.Bring({2, {{0, 1, {0, 0, -9, 9}}}});
                        }),
              HasSubstr("impossible numbers"));
  EXPECT_EQ(detector.TakeAnswer()->number, 1);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { detector.Detect({}); }),
              HasSubstr("asynchronously"));
}

TEST(LateDetector, KeepsTheBestOfTooMany) {
  const WarningCatcher warnings;
  LateDetector detector({"person"});
  for (int number : {1, 2}) {
    std::vector<Detection> many(100000, Detection{0, 0.5f, {1, 2, 3, 4}});
    many.back().score = 0.9f;
    detector.Bring({number, many});
    const auto answer = detector.TakeAnswer();
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ(answer->detections.size(), static_cast<size_t>(kMostDetections));
    EXPECT_EQ(answer->detections[0].score, 0.9f);
  }
  EXPECT_THAT(warnings.text(), HasSubstr("100000 objects"));
  EXPECT_EQ(std::count(warnings.text().begin(), warnings.text().end(), '\n'), 1);
}

}  // namespace
}  // namespace alidade::late_detector_test
