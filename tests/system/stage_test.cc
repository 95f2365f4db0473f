// One worker in all schedules, and several workers that make each other rest.
#include "alidade/system/workers/stage.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "alidade/system/health.h"

namespace alidade::stage_test {
namespace {

constexpr Schedule kAll[] = {Schedule::kInline, Schedule::kThread, Schedule::kBackground};
constexpr Schedule kThreaded[] = {Schedule::kThread, Schedule::kBackground};

void Until(const std::function<bool()>& holds) {
  while (!holds()) std::this_thread::yield();
}

TEST(Stage, DoesEachKeyFrameOnceAndInOrder) {
  for (Schedule schedule : kAll) {
    std::vector<uint32_t> done;
    Stage stage([&](KeyFrameId id, const std::atomic<bool>*) { done.push_back(id.value); },
                schedule);
    for (uint32_t i = 0; i < 50; ++i) stage.Add({i});
    stage.Drain();
    ASSERT_EQ(done.size(), 50u);
    for (uint32_t i = 0; i < 50; ++i) EXPECT_EQ(done[i], i);
    EXPECT_EQ(stage.milliseconds().All().size(), 50u);
    EXPECT_EQ(stage.backlog(), 0);
  }
}

TEST(Stage, InlineItIsDoneBeforeAddReturnsAndNeverHurried) {
  int done = 0;
  bool hurried = false;
  Stage stage(
      [&](KeyFrameId, const std::atomic<bool>* stop) {
        ++done;
        hurried = hurried || stop != nullptr;
      },
      Schedule::kInline);
  stage.Add({0});
  EXPECT_EQ(done, 1);
  stage.Add({1});
  EXPECT_EQ(done, 2);
  EXPECT_FALSE(hurried);
}

TEST(Stage, WhatWorkThrowsEndsItInSilenceButForFailure) {
  for (Schedule schedule : kAll) {
    std::atomic<int> done{0};
    Stage stage(
        [&](KeyFrameId id, const std::atomic<bool>*) {
          if (id.value == 1) throw std::runtime_error("broken");
          ++done;
        },
        schedule);
    EXPECT_EQ(stage.failure(), nullptr);
    stage.WhileResting([&] {
      if (schedule == Schedule::kInline) return;  // inline nothing is queued
      for (uint32_t i = 0; i < 5; ++i) stage.Add({i});
      EXPECT_TRUE(stage.AddErrand([&] { ++done; }));
    });
    for (uint32_t i = 0; i < 5 && schedule == Schedule::kInline; ++i) stage.Add({i});
    stage.Drain();
    EXPECT_EQ(done, 1);  // the first; work queued behind the second was dropped
    EXPECT_EQ(WhatOf(stage.failure()), "broken");
    EXPECT_EQ(stage.backlog(), 0);

    stage.Add({7});
    EXPECT_FALSE(stage.AddErrand([&] { ++done; }));
    stage.Guard([&] { ++done; });
    stage.Drain();
    EXPECT_EQ(done, 1);
    EXPECT_EQ(stage.backlog(), 0);
    bool ran = false;  // a failed stage can still be made to rest
    stage.WhileResting([&] { ran = true; });
    EXPECT_TRUE(ran);
  }
}

TEST(Stage, ThrowsOfAnyTypeAreKept) {
  for (Schedule schedule : kAll) {
    Stage number([](KeyFrameId, const std::atomic<bool>*) { throw 42; }, schedule);
    number.Add({0});
    number.Drain();
    EXPECT_EQ(WhatOf(number.failure()), "unknown exception");
    Stage memory([](KeyFrameId, const std::atomic<bool>*) { throw std::bad_alloc(); }, schedule);
    memory.Add({0});
    memory.Drain();
    EXPECT_EQ(WhatOf(memory.failure()), "out of memory");
  }
}

TEST(Stage, AnErrandIsRunInTurnAndIsNoKeyFrame) {
  for (Schedule schedule : kAll) {
    std::vector<int> done;
    Stage stage([&](KeyFrameId id,
                    const std::atomic<bool>*) { done.push_back(static_cast<int>(id.value)); },
                schedule);
    stage.WhileResting([&] {
      stage.Add({1});
      stage.AddErrand([&] { done.push_back(-1); });
      stage.Add({2});
    });
    stage.Drain();
    EXPECT_EQ(done, (std::vector<int>{1, -1, 2}));
    EXPECT_EQ(stage.milliseconds().All().size(), 2u);
  }
}

TEST(Stage, WhatItsOwnersDoForItIsItsFailureToo) {
  for (Schedule schedule : kAll) {
    int done = 0;
    Stage stage([&](KeyFrameId, const std::atomic<bool>*) { ++done; }, schedule);
    stage.Guard([] { throw std::runtime_error("on the caller's thread"); });
    EXPECT_EQ(WhatOf(stage.failure()), "on the caller's thread");
    stage.Add({0});
    stage.Drain();
    EXPECT_EQ(done, 0);
  }
}

TEST(Stage, WorkIsToldToHurryWhenMoreComes) {
  for (Schedule schedule : kThreaded) {
    std::atomic<bool> begun{false};
    std::atomic<int> hurried{0};
    Stage stage(
        [&](KeyFrameId id, const std::atomic<bool>* stop) {
          if (id.value > 0) return;
          EXPECT_FALSE(*stop);
          begun = true;
          Until([&] { return stop->load(); });
          ++hurried;
        },
        schedule);
    stage.Add({0});
    Until([&] { return begun.load(); });
    stage.Add({1});  // unless *stop becomes true, the first never ends
    stage.Drain();
    EXPECT_EQ(hurried, 1);
  }
}

TEST(Stage, WorkIsToldToHurryWhenSomeoneWaitsForRest) {
  for (Schedule schedule : kThreaded) {
    std::atomic<bool> begun{false}, ended{false};
    Stage stage(
        [&](KeyFrameId, const std::atomic<bool>* stop) {
          begun = true;
          Until([&] { return stop->load(); });
          ended = true;
        },
        schedule);
    stage.Add({0});
    Until([&] { return begun.load(); });
    bool ended_before = false;
    stage.WhileResting([&] { ended_before = ended; });
    EXPECT_TRUE(ended_before);
    stage.Drain();
  }
}

TEST(Stage, TheLastOfAQueueIsNotHurried) {
  for (Schedule schedule : kThreaded) {
    std::atomic<bool> hurried{true};
    Stage stage(
        [&](KeyFrameId id, const std::atomic<bool>* stop) {
          if (id.value == 9) hurried = stop->load();
        },
        schedule);
    stage.WhileResting([&] {  // so that all are queued before the first is processed
      for (uint32_t i = 0; i < 10; ++i) stage.Add({i});
    });
    stage.Drain();
    EXPECT_FALSE(hurried);
  }
}

TEST(Stage, NothingIsInWorkWhileItRests) {
  for (Schedule schedule : kThreaded) {
    std::atomic<int> working{0}, done{0};
    Stage stage(
        [&](KeyFrameId, const std::atomic<bool>*) {
          ++working;
          std::this_thread::yield();
          ++done;
          --working;
        },
        schedule);
    int overlaps = 0;
    for (uint32_t i = 0; i < 200; ++i) {
      stage.Add({i});
      stage.WhileResting([&] {
        const int before = done;
        overlaps += working;
        std::this_thread::yield();
        overlaps += working + (done - before);
      });
    }
    stage.Drain();
    EXPECT_EQ(overlaps, 0);
    EXPECT_EQ(done, 200);
  }
}

TEST(Stage, WorkGoesOnAfterARestThatThrew) {
  for (Schedule schedule : kAll) {
    int done = 0;
    Stage stage([&](KeyFrameId, const std::atomic<bool>*) { ++done; }, schedule);
    EXPECT_THROW(stage.WhileResting([] { throw std::runtime_error("no"); }), std::runtime_error);
    stage.Add({0});
    stage.Drain();
    EXPECT_EQ(done, 1);
  }
}

TEST(Stage, StopEndsWhatIsInWorkAndDropsTheQueue) {
  for (Schedule schedule : kThreaded) {
    std::atomic<bool> begun{false};
    std::atomic<int> done{0};
    Stage stage(
        [&](KeyFrameId, const std::atomic<bool>* stop) {
          begun = true;
          Until([&] { return stop->load(); });
          ++done;
        },
        schedule);
    stage.Add({0});
    Until([&] { return begun.load(); });
    stage.Stop();
    EXPECT_EQ(done, 1);
    stage.Stop();  // a second call does nothing
  }
  std::atomic<int> done{0};
  {
    Stage stage([&](KeyFrameId, const std::atomic<bool>*) { ++done; }, Schedule::kThread);
    stage.WhileResting([&] {
      for (uint32_t i = 0; i < 5; ++i) stage.Add({i});
      stage.Stop();  // while it rests, with work queued
    });
    EXPECT_EQ(stage.backlog(), 0);
  }
  EXPECT_EQ(done, 0);
}

// As in Workers: a mapper passes keyframes to a loop closer, which makes the mapper rest and passes
// some to an adjuster, which makes the mapper rest, too; the tracker makes the first two rest from
// outside. If the test hangs, there is a deadlock.
TEST(Stage, ThreeStagesThatMakeEachOtherRestComeToAnEnd) {
  for (int round = 0; round < 3; ++round) {
    std::atomic<int> mapped{0}, closed{0}, adjusted{0}, changed{0}, in_mapping{0}, overlaps{0};
    Stage *mapping_stage = nullptr, *adjusting_stage = nullptr;
    Stage adjusting(
        [&](KeyFrameId, const std::atomic<bool>*) {
          mapping_stage->WhileResting([&] { overlaps += in_mapping; });
          ++adjusted;
        },
        Schedule::kBackground);
    Stage looping(
        [&](KeyFrameId id, const std::atomic<bool>*) {
          mapping_stage->WhileResting([&] { overlaps += in_mapping; });
          ++closed;
          if (id.value % 3 == 0) adjusting_stage->Add(id);
        },
        Schedule::kBackground);
    Stage mapping(
        [&](KeyFrameId id, const std::atomic<bool>*) {
          ++in_mapping;
          std::this_thread::yield();
          ++mapped;
          --in_mapping;
          looping.Add(id);
        },
        Schedule::kThread);
    mapping_stage = &mapping;
    adjusting_stage = &adjusting;
    for (uint32_t i = 0; i < 400; ++i) {
      mapping.Add({i});
      if (i % 7 == 0)
        looping.WhileResting([&] {
          mapping.WhileResting([&] {
            overlaps += in_mapping;
            ++changed;
          });
        });
    }
    if (round == 0) {
      mapping.Drain();
      looping.Drain();
      adjusting.Drain();
      EXPECT_EQ(mapped, 400);
      EXPECT_EQ(closed, 400);
      EXPECT_EQ(adjusted, 134);
    }  // in the other rounds: stopped while they work
    mapping.Stop();
    looping.Stop();
    adjusting.Stop();
    EXPECT_EQ(changed, 58);
    EXPECT_EQ(overlaps, 0);
  }
}

}  // namespace
}  // namespace alidade::stage_test
