// Objects tracked from frame to frame while detector results are late or missing.
#include "alidade/dynamics/objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "support/vga_camera.h"

namespace alidade::objects_test {
namespace {

const std::vector<std::string> kNames = {"person", "chair", "toaster", "chairlift"};
enum Class { kPerson, kChair, kToaster, kChairlift };
const cv::Size kImage(640, 480);
constexpr double kFrame = 1 / 30.0;  // seconds

float Apart(const cv::Rect2f& a, const cv::Rect2f& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.br().x - b.br().x),
                   std::abs(a.br().y - b.br().y)});
}

// An object that moves at `step` pixels per frame over a background that moves at `background`, and
// the flow of both.
class ObjectTracksTest : public testing::Test {
 protected:
  cv::Rect2f BoxAt(int frame) const { return begin_ + static_cast<float>(frame) * step_; }

  // Tracks in frame `now_`.
  std::vector<FlowTrack> Flow() const {
    std::vector<FlowTrack> tracks;
    uint32_t id = 0;
    const auto add = [&](cv::Point2f p, cv::Point2f step) {
      FlowTrack track;
      track.id = id++;
      for (int frame = std::max(0, now_ - FlowTracks::kHistory + 1); frame <= now_; ++frame)
        track.path.push_back(p + static_cast<float>(frame) * step);
      tracks.push_back(track);
    };
    if (!flow_) return tracks;
    for (float y = 10; y < 480; y += 25) {
      for (float x = 10; x < 640; x += 25) {
        const cv::Point2f p(x, y);
        if (!BoxAt(now_).contains(p)) add(p - static_cast<float>(now_) * background_, background_);
      }
    }
    for (float y = begin_.y + 5; y < begin_.br().y; y += 20) {
      for (float x = begin_.x + 5; x < begin_.br().x; x += 20) add({x, y}, step_);
    }
    return tracks;
  }
  void Advance(int frames = 1) {
    for (int i = 0; i < frames; ++i) {
      ++now_;
      objects_.Advance(Flow(), cells_, now_ * kFrame, kImage);
    }
  }
  void Detect(std::vector<Detection> detections, int ago) {
    objects_.Update(detections, ago, (now_ - ago) * kFrame, Flow());
  }
  Detection Person(int ago) const { return {kPerson, 0.9f, BoxAt(now_ - ago)}; }

  Cells cells_{MakeVgaCamera()};
  DynamicsSettings settings_;
  ObjectTracks objects_{settings_, kNames};
  cv::Rect2f begin_{150, 120, 110, 230};
  cv::Point2f step_{6, -1}, background_{-2, 0};
  bool flow_ = true;
  int now_ = 0;
};

TEST_F(ObjectTracksTest, AnAnswerThatIsLateLandsOnWhatHasMovedOn) {
  for (int late : {0, 1, 6, 10}) {
    objects_ = ObjectTracks(settings_, kNames);
    now_ = 0;
    Advance(15);
    Detect({Person(late)}, late);
    ASSERT_EQ(objects_.objects().size(), 1u);
    EXPECT_LT(Apart(objects_.objects()[0].box, BoxAt(now_)), 3) << late;
  }
}

TEST_F(ObjectTracksTest, ASecondAnswerIsOfTheSameThing) {
  const int late = 6;
  Advance(10);
  for (int i = 0; i < 4; ++i) {
    Advance(6);
    Detect({Person(late)}, late);
    ASSERT_EQ(objects_.objects().size(), 1u);
    EXPECT_EQ(objects_.objects()[0].id, 0);
    EXPECT_LT(Apart(objects_.objects()[0].box, BoxAt(now_)), 6);
  }
}

TEST_F(ObjectTracksTest, WhatIsNotDetectedGoesOnWithItsFlowAndIsThenForgotten) {
  step_ = {3, 0};
  Detect({Person(0)}, 0);
  const int bridged = static_cast<int>(settings_.bridge_seconds / kFrame);
  for (int i = 0; i + 2 < bridged; ++i) {
    Advance();
    ASSERT_EQ(objects_.objects().size(), 1u) << i;
    ASSERT_LT(Apart(objects_.objects()[0].box, BoxAt(now_)), 6) << i;
  }
  Advance(5);
  EXPECT_TRUE(objects_.objects().empty());
}

TEST_F(ObjectTracksTest, EachDetectionBeginsTheWaitAnew) {
  step_ = {1, 0};
  for (int i = 0; i < 6; ++i) {
    Detect({Person(0)}, 0);
    Advance(static_cast<int>(0.7 * settings_.bridge_seconds / kFrame));
    ASSERT_EQ(objects_.objects().size(), 1u);
    ASSERT_EQ(objects_.objects()[0].id, 0);
  }
}

TEST_F(ObjectTracksTest, WithoutFlowItGoesOnAsItMovedBefore) {
  Detect({Person(0)}, 0);
  Advance(5);
  flow_ = false;
  Advance(5);
  ASSERT_EQ(objects_.objects().size(), 1u);
  EXPECT_LT(Apart(objects_.objects()[0].box, BoxAt(now_)), 8);
}

TEST_F(ObjectTracksTest, WhatHasLeftThePictureIsForgotten) {
  begin_ = {500, 100, 100, 200};
  step_ = {12, 0};
  Detect({Person(0)}, 0);
  Advance(8);
  EXPECT_EQ(objects_.objects().size(), 1u);
  Advance(8);
  EXPECT_TRUE(objects_.objects().empty());
}

TEST_F(ObjectTracksTest, RolesAreThoseOfTheSettings) {
  Detect({{kPerson, 0.9f, {0, 0, 100, 200}},
          {kChair, 0.9f, {200, 0, 100, 100}},
          {kToaster, 0.9f, {400, 0, 100, 100}},
          {kChairlift, 0.9f, {400, 200, 100, 100}},
          {-1, 0.9f, {0, 300, 100, 100}},
          {99, 0.9f, {200, 300, 100, 100}}},
         0);
  ASSERT_EQ(objects_.objects().size(), 2u);
  EXPECT_EQ(objects_.objects()[0].class_id, kPerson);
  EXPECT_FALSE(objects_.objects()[0].carried);
  EXPECT_EQ(objects_.objects()[1].class_id, kChair);
  EXPECT_TRUE(objects_.objects()[1].carried);

  settings_.moving_classes = "toaster";
  settings_.carried_classes = "";
  objects_ = ObjectTracks(settings_, kNames);
  Detect({Person(0), {kToaster, 0.9f, {400, 0, 100, 100}}}, 0);
  ASSERT_EQ(objects_.objects().size(), 1u);
  EXPECT_EQ(objects_.objects()[0].class_id, kToaster);
  EXPECT_FALSE(objects_.objects()[0].carried);
}

TEST_F(ObjectTracksTest, TwoThingsApartAreTwo) {
  const auto both = [&] {
    return std::vector<Detection>{Person(0), {kPerson, 0.8f, {430, 200, 100, 200}}};
  };
  Detect(both(), 0);
  ASSERT_EQ(objects_.objects().size(), 2u);
  EXPECT_NE(objects_.objects()[0].id, objects_.objects()[1].id);
  Detect(both(), 0);
  EXPECT_EQ(objects_.objects().size(), 2u);
}

TEST_F(ObjectTracksTest, WhatIsSeenToRestIsBelievedALittleUntilItMoves) {
  Detect({Person(0)}, 0);
  MovingObject& person = objects_.objects()[0];
  person.cells = CellsInBox(cells_, person.box);
  const std::vector<FlowTrack> tracks = Flow();
  const auto judge = [&](int8_t vote, int frames) {
    const std::vector<int8_t> votes(tracks.size(), vote);
    for (int i = 0; i < frames; ++i) objects_.JudgeRest(tracks, votes, cells_);
    return person.static_log_odds;
  };
  EXPECT_FLOAT_EQ(judge(0, 100), kObjectStatic);  // undecided
  EXPECT_LT(judge(1, 10), kRestingStatic);
  EXPECT_FLOAT_EQ(judge(1, 100), kRestingStatic);
  EXPECT_FLOAT_EQ(judge(-1, 4), kObjectStatic);
}

// --- Segmentation of a box ---

class ForegroundTest : public testing::Test {
 protected:
  // A room: a wall at 4 m, a person at 2 m in an oval that does not fill its box.
  ForegroundTest() : depth_(cells_.count(), 4), static_(cells_.count(), 1.5f) {
    person_ = CellsWhere([&](cv::Point2f p) { return InPerson(p); });
    for (int i : person_) depth_[i] = 2 + 0.002f * (cells_.Centre(i).x - 320);  // inclined
  }
  bool InPerson(cv::Point2f p) const {
    const float u = (p.x - 320) / 60, v = (p.y - 260) / 150;
    return u * u + v * v < 1;
  }
  template <typename Inside>
  std::vector<int> CellsWhere(Inside&& inside) const {
    std::vector<int> found;
    for (int i = 0; i < cells_.count(); ++i) {
      if (inside(cells_.Centre(i))) found.push_back(i);
    }
    return found;
  }
  static double ShareFound(const std::vector<int>& wanted, const std::vector<int>& found) {
    int count = 0;
    for (int i : wanted) count += std::binary_search(found.begin(), found.end(), i);
    return static_cast<double>(count) / static_cast<double>(wanted.size());
  }

  Cells cells_{MakeVgaCamera()};
  std::vector<float> depth_, static_;
  std::vector<int> person_;
  cv::Rect2f box_{260, 110, 120, 300};
};

TEST_F(ForegroundTest, IsThePersonAndNotTheWallBehind) {
  const std::vector<int> found = FindForeground(cells_, depth_, static_, box_);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  EXPECT_GT(ShareFound(person_, found), 0.97);
  EXPECT_GT(ShareFound(found, person_), 0.97);
}

TEST_F(ForegroundTest, IsNotWhatIsKnownToStandInFront) {
  // A chair hides the legs and a part of the wall.
  const auto chair = CellsWhere([](cv::Point2f p) { return p.y > 300 && p.x > 200 && p.x < 460; });
  for (int i : chair) {
    depth_[i] = 1.8f;
    static_[i] = 5;
  }
  const std::vector<int> found = FindForeground(cells_, depth_, static_, box_);
  EXPECT_LT(ShareFound(chair, found), 0.02);
  std::vector<int> seen;
  std::set_difference(person_.begin(), person_.end(), chair.begin(), chair.end(),
                      std::back_inserter(seen));
  EXPECT_GT(ShareFound(seen, found), 0.95);
}

TEST_F(ForegroundTest, IsThePersonBelowATableTopAsWell) {
  const auto legs = CellsWhere([&](cv::Point2f p) { return p.y > 330 && InPerson(p); });
  for (int i : legs) depth_[i] += 0.3f;  // a camera that looks down
  const auto top = CellsWhere([](cv::Point2f p) { return p.y > 290 && p.y < 330; });
  for (int i : top) {
    depth_[i] = 1.6f;
    static_[i] = 5;
  }
  const std::vector<int> found = FindForeground(cells_, depth_, static_, box_);
  EXPECT_LT(ShareFound(top, found), 0.02);
  EXPECT_GT(ShareFound(legs, found), 0.9);
  EXPECT_GT(ShareFound(found, person_), 0.97);
}

TEST_F(ForegroundTest, IsThePersonThoughItStoodStillUntilNow) {
  for (int i : person_) static_[i] = 5;
  const std::vector<int> found = FindForeground(cells_, depth_, static_, box_);
  EXPECT_GT(ShareFound(person_, found), 0.95);
  EXPECT_GT(ShareFound(found, person_), 0.95);
}

TEST_F(ForegroundTest, TakesInTheHolesOfThePersonAndNotThoseOfTheWall) {
  for (int i = 0; i < cells_.count(); ++i) {
    if ((i * 7919) % 10 == 0) depth_[i] = 0;
  }
  const std::vector<int> found = FindForeground(cells_, depth_, static_, box_);
  EXPECT_GT(ShareFound(person_, found), 0.93);
  EXPECT_GT(ShareFound(found, person_), 0.93);
}

TEST_F(ForegroundTest, IsAnOvalWhereNoDepthIsKnown) {
  std::fill(depth_.begin(), depth_.end(), 0.0f);
  EXPECT_EQ(FindForeground(cells_, depth_, static_, box_), CellsInOval(cells_, box_));
}

TEST_F(ForegroundTest, BoxesAtTheBordersAndBeyondAreOfNoHarm) {
  for (const cv::Rect2f& box : {cv::Rect2f(-50, -40, 120, 200), cv::Rect2f(600, 400, 100, 200),
                                cv::Rect2f(0, 0, 640, 480), cv::Rect2f(-100, -100, 900, 900),
                                cv::Rect2f(700, 100, 50, 50), cv::Rect2f(300, 200, 1, 1)}) {
    for (int i : FindForeground(cells_, depth_, static_, box)) {
      ASSERT_GE(i, 0);
      ASSERT_LT(i, cells_.count());
    }
  }
}

TEST_F(ForegroundTest, AnOvalIsMostOfItsBoxButNotItsCorners) {
  const std::vector<int> found = CellsInOval(cells_, box_);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  const auto has = [&](float x, float y) {
    return std::binary_search(found.begin(), found.end(), cells_.At(x, y));
  };
  EXPECT_TRUE(has(320, 260));
  EXPECT_TRUE(has(270, 260));
  EXPECT_TRUE(has(320, 120));
  EXPECT_FALSE(has(262, 112));
  EXPECT_FALSE(has(378, 408));
  EXPECT_FALSE(has(240, 260));
  const double share = static_cast<double>(found.size()) * cells_.size() * cells_.size() /
                       static_cast<double>(box_.area());
  EXPECT_GT(share, 0.7);  // an ellipse has 0.785; the cells on its rim vary
  EXPECT_LT(share, 1.0);
}

TEST_F(ForegroundTest, WhatIsProvenToStandIsLeftOutAtTheRimOfTheOvalOnly) {
  const std::vector<uint8_t> proven(cells_.count(), 1);
  const std::vector<int> all = CellsInOval(cells_, box_), found = CellsInOval(cells_, box_, proven);
  EXPECT_LT(found.size(), all.size());
  EXPECT_FALSE(found.empty());
  EXPECT_TRUE(std::binary_search(found.begin(), found.end(), cells_.At(320, 260)));
  for (int i : found) EXPECT_TRUE(std::binary_search(all.begin(), all.end(), i));
}

}  // namespace
}  // namespace alidade::objects_test
