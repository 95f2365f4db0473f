// The state machine of a run: every event in every state.
#include "alidade/system/session.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace alidade::session_test {
namespace {

using State = SessionState;
using Event = SessionEvent;

constexpr State kStates[] = {State::kSeeking, State::kConfirming, State::kTracking, State::kLost};
constexpr const char* kStateNames[] = {"seeking", "confirming", "tracking", "lost"};

// The names of what is erased, in the order of the fields.
std::string Names(const Erasure& erase) {
  std::string names;
  const auto add = [&](bool erased, const char* name) {
    if (erased) names += names.empty() ? name : std::string(" ") + name;
  };
  add(erase.newest_map, "map");
  add(erase.start_views, "views");
  add(erase.motion, "motion");
  add(erase.passing_points, "passing");
  add(erase.moving_objects, "moving");
  add(erase.dynamics, "dynamics");
  add(erase.waiting_frames, "waiting");
  add(erase.kept_frames, "kept");
  return names;
}

struct Row {
  Event event;
  const char* name;
  // The next state and what is erased, by the state before: seeking, confirming, tracking, lost.
  State next[4];
  const char* erased[4];
};

constexpr State S = State::kSeeking, C = State::kConfirming, T = State::kTracking, L = State::kLost;
constexpr char kMap[] = "map views motion moving";

const Row kTable[] = {
    {Event::kMapLoaded, "map loaded", {L, L, L, L}, {"", "", "", ""}},
    {Event::kDepthStart, "depth start", {T, T, T, T}, {"motion", "motion", "motion", "motion"}},
    {Event::kTwoViewStart, "two-view start", {C, C, C, C}, {"", "", "", ""}},
    {Event::kMapConfirmed, "map confirmed", {T, T, T, T}, {"", "", "", ""}},
    {Event::kMapRefused, "map refused", {S, S, S, S}, {kMap, kMap, kMap, kMap}},
    {Event::kPoseLost, "pose lost", {S, S, L, L}, {"", kMap, "passing", ""}},
    {Event::kPoseResumed,
     "pose resumed",
     {T, T, T, T},
     {"views waiting", "views waiting", "views waiting", "views waiting"}},
    {Event::kRelocalized,
     "relocalized",
     {T, T, T, T},
     {"views motion waiting", "views motion waiting", "views motion waiting",
      "views motion waiting"}},
    {Event::kLostForLong,
     "lost for long",
     {S, S, S, S},
     {"views motion kept", "views motion kept", "views motion kept", "views motion kept"}},
    {Event::kMapLeft,
     "map left",
     {S, S, S, S},
     {"views motion waiting kept", "map views motion moving waiting kept",
      "views motion waiting kept", "views motion waiting kept"}},
    {Event::kCut,
     "cut",
     {S, S, L, L},
     {"views motion waiting kept", "map views motion moving waiting kept",
      "motion passing waiting kept", "motion waiting kept"}},
    {Event::kRebuildStarted,
     "rebuild started",
     {S, S, S, S},
     {"map views motion moving waiting", "map views motion moving waiting",
      "map views motion moving waiting", "map views motion moving waiting"}},
    {Event::kFrameFailed,
     "frame failed",
     {S, C, T, L},
     {"views dynamics", "views dynamics", "views dynamics", "views dynamics"}},
};

TEST(Session, EveryEventInEveryStateLeadsToOneStateAndErasesWhatIsUseless) {
  for (const Row& row : kTable) {
    for (int i = 0; i < 4; ++i) {
      SCOPED_TRACE(std::string(row.name) + " while " + kStateNames[i]);
      const Transition transition = After(kStates[i], row.event);
      EXPECT_EQ(transition.next, row.next[i]);
      EXPECT_EQ(Names(transition.erase), row.erased[i]);
    }
  }
}

TEST(Session, TheTableHasEveryEvent) {
  EXPECT_EQ(std::size(kTable), static_cast<size_t>(Event::kFrameFailed) + 1);
}

TEST(Session, AStateWithoutAPoseIsNeverLeftForOneWithAPoseButByAStartOrARecognizedPlace) {
  for (const Row& row : kTable) {
    for (State before : {S, L}) {
      const State next = After(before, row.event).next;
      const bool gains_pose = next == C || next == T;
      const bool may = row.event == Event::kDepthStart || row.event == Event::kTwoViewStart ||
                       row.event == Event::kMapConfirmed || row.event == Event::kPoseResumed ||
                       row.event == Event::kRelocalized;
      EXPECT_TRUE(!gains_pose || may) << row.name;
    }
  }
}

// A pose that is lost with its motion may not be extrapolated from another map.
TEST(Session, WhateverDropsAMapForgetsTheMotionInIt) {
  for (const Row& row : kTable) {
    for (State before : kStates) {
      const Erasure erase = After(before, row.event).erase;
      EXPECT_TRUE(!erase.newest_map || (erase.motion && erase.start_views)) << row.name;
    }
  }
}

}  // namespace
}  // namespace alidade::session_test
