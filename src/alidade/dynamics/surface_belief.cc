#include "alidade/dynamics/surface_belief.h"

#include <algorithm>
#include <cmath>

#include "alidade/base/log_odds.h"
#include "alidade/dynamics/evidence.h"

namespace alidade {
namespace {

constexpr float kForget = 0.01f;    // share of the way back to what is unknown, per frame
constexpr float kRemember = 0.95f;  // of certainty, per frame
constexpr float kLearn = 0.3f;      // certainty, by the weight of a frame's evidence

}  // namespace

SurfaceBelief::SurfaceBelief(const Cells& cells)
    : cells_(cells), log_odds_(cells.count(), kUnknownStatic), certainty_(cells.count(), 0) {}

std::vector<int> SurfaceBelief::Carry(std::span<const float> depth, const Se3& T_camera_world,
                                      const History& history) {
  std::vector<int> from(cells_.count(), -1);
  for (int ago = 1; ago <= kGap; ++ago) {
    const PastView* last = history.Before(ago);
    if (!last || last->number != number_) continue;
    from = CompareDepth(cells_, depth, T_camera_world, *last).met;
    break;
  }
  std::vector<float> log_odds(cells_.count(), kUnknownStatic), certainty(cells_.count(), 0);
  for (int i = 0; i < cells_.count(); ++i) {
    if (from[i] < 0) continue;
    log_odds[i] = log_odds_[from[i]] + kForget * (kUnknownStatic - log_odds_[from[i]]);
    certainty[i] = kRemember * certainty_[from[i]];
  }
  log_odds_ = std::move(log_odds);
  certainty_ = std::move(certainty);
  return from;
}

// What stands where one looked through before has come since; what was there a while ago already
// and was not thought to move stands still.
void SurfaceBelief::AddDepth(int number, std::span<const float> depth, const Se3& T_camera_world,
                             const History& history, Evidence& evidence) const {
  constexpr float kFree = -1.5f, kSame = 0.2f;  // log-odds, per frame
  constexpr float kYoung = 30;     // frames: how long a thing must have been there to count fully
  constexpr float kSettled = 75;   // frames after which a mover that stays has come to rest …
  constexpr float kRested = 0.5f;  // … as likely as not
  constexpr float kTrusted = 0.4f;
  std::vector<float> same(cells_.count(), 0);
  std::vector<uint8_t> free(cells_.count(), 0);
  const auto compare = [&](const PastView* past) {
    if (!past || past->depth.empty()) return;
    const DepthComparison comparison = CompareDepth(cells_, depth, T_camera_world, *past);
    const auto frames = static_cast<float>(number - past->number);
    const float age = std::min(1.0f, frames / kYoung), least = frames >= kSettled ? kRested : 0;
    for (int i = 0; i < cells_.count(); ++i) {
      free[i] |= comparison.result[i] == Comparison::kFree;
      if (comparison.result[i] != Comparison::kSame) continue;
      const float before = past->static_log_odds[comparison.met[i]];
      const float trust = std::max(before > kObjectStatic ? least : 0, ProbabilityOf(before));
      same[i] = std::max(same[i], age * trust);
    }
  };
  for (size_t k : {size_t{8}, size_t{4}, size_t{1}}) compare(history.Older(k));
  for (int ago : {16, 7}) compare(history.Before(ago));
  for (int i = 0; i < cells_.count(); ++i) {
    const bool moved = free[i] && same[i] < kTrusted;
    const float weight = moved ? 1 : same[i];
    evidence.weights[i] += weight;
    evidence.log_odds[i] += weight * (moved ? kFree : kSame);
  }
}

void SurfaceBelief::AddFlow(std::span<const float> depth, std::span<const FlowTrack> tracks,
                            std::span<const int8_t> votes, Evidence& evidence) const {
  constexpr float kConfirmed = 0.06f;              // evidence of depth that something stands still
  constexpr float kMoved = -0.5f, kStood = 0.02f;  // log-odds, per frame and track
  constexpr float kStoodWeight = 0.2f;
  for (size_t t = 0; t < tracks.size(); ++t) {
    if (votes[t] == 0) continue;
    const bool moved = votes[t] < 0;
    const int cell = cells_.At(tracks[t].at().x, tracks[t].at().y);
    cells_.VisitAround(cell, 1, [&](int n) {
      if (ApartInDepth(depth, cell, n) || (moved && evidence.log_odds[n] > kConfirmed)) return;
      evidence.log_odds[n] += moved ? kMoved : kStood;
      evidence.weights[n] += moved ? 1 : kStoodWeight;
    });
  }
}

// What little is known of takes after the surface it is on.
void SurfaceBelief::Spread(std::span<const float> depth, std::span<const uint8_t> suspect) {
  constexpr float kFade = 0.75f;   // from cell to cell
  constexpr float kRate = 0.3f;    // share of the way, per frame
  constexpr float kHeard = 20;     // by the weight of what is around
  constexpr float kLeast = -0.5f;  // log-odds: hearsay alone makes no mover for long
  std::vector<float> values = log_odds_, weights(cells_.count());
  for (int i = 0; i < cells_.count(); ++i) weights[i] = certainty_[i] * certainty_[i];
  SpreadOverSurfaces(cells_, depth, kFade, values, weights);
  for (int i = 0; i < cells_.count(); ++i) {
    const float share = kRate * (1 - certainty_[i]) * std::min(1.0f, kHeard * weights[i]);
    const float heard =
        suspect[i] ? values[i] : std::max(values[i], std::min(kLeast, log_odds_[i]));
    log_odds_[i] += share * (heard - log_odds_[i]);
  }
}

void SurfaceBelief::Update(int number, std::span<const float> depth, const Se3& T_camera_world,
                           const History& history, std::span<const uint8_t> resting,
                           std::span<const uint8_t> suspect, std::span<const FlowTrack> tracks,
                           std::span<const int8_t> votes) {
  number_ = number;
  Evidence evidence{std::vector<float>(cells_.count(), 0), std::vector<float>(cells_.count(), 0)};
  AddDepth(number, depth, T_camera_world, history, evidence);
  AddFlow(depth, tracks, votes, evidence);
  for (int i = 0; i < cells_.count(); ++i) {
    if (resting[i] && evidence.log_odds[i] > 0) continue;
    log_odds_[i] = std::clamp(log_odds_[i] + evidence.log_odds[i], -kCertainStatic, kCertainStatic);
    certainty_[i] = std::min(1.0f, certainty_[i] + kLearn * evidence.weights[i]);
  }
  Spread(depth, suspect);
}

}  // namespace alidade
