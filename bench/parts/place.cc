// Place recognition: which revisits are found, beside matching all against all; and what it costs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "alidade/base/random.h"
#include "alidade/base/timing.h"
#include "alidade/features/matching.h"
#include "alidade/place/place_index.h"
#include "bench/measure/reference.h"
#include "bench/parts/parts.h"
#include "bench/parts/revisits.h"

namespace alidade::bench {
namespace {

constexpr double kSame = 0.5;  // of the view shared: the same place
constexpr double kElsewhere =
    0.1;                     // less than this: somewhere else, and to say the same is an error
constexpr int kMany = 1024;  // keyframes: a power of two, at which the vocabulary is grown

// What a method says of one frame: the likest of the keyframes of earlier visits.
struct Answer {
  double score = 0;
  double shared = 0;  // of the view, with the one it named
};

struct Answers {
  std::vector<Answer> best_first;
  int revisits = 0;  // frames that do share kSame with some keyframe of an earlier visit
};

// Precision over the answers accepted when as many revisits as `recall` says are found; 0 when they
// never are. Wrong are the answers that share less than `wrong`; others below kSame do not count.
double PrecisionAt(const Answers& answers, double recall, double wrong) {
  int right = 0, errors = 0;
  for (const Answer& answer : answers.best_first) {
    right += answer.shared >= kSame;
    errors += answer.shared < wrong;
    if (right > 0 && right >= recall * answers.revisits) {
      return static_cast<double>(right) / (right + errors);
    }
  }
  return 0;
}

// The share of revisits found before the first wrong answer.
double RecallWithoutErrors(const Answers& answers, double wrong) {
  int right = 0;
  double wrong_score = -1;
  for (const Answer& answer : answers.best_first) {
    if (answer.shared < wrong) {
      wrong_score = answer.score;
      break;
    }
  }
  for (const Answer& answer : answers.best_first) {
    right += answer.shared >= kSame && answer.score > wrong_score;
  }
  return answers.revisits > 0 ? static_cast<double>(right) / answers.revisits : 0;
}

// Asks for each frame, then adds it when it is a keyframe, as a loop closer does. `best`: of frame
// q among the keyframes up to `last`, as (frame or -1, score).
template <typename Best, typename Add>
Answers Ask(const std::vector<PosedFrame>& frames, const SharedViews& views, Best&& best,
            Add&& add) {
  Answers answers;
  for (int q = 0; q < views.size(); ++q) {
    const int last = views.LastOfEarlierVisits(q);
    bool revisit = false;
    for (int k = 0; k <= last; ++k) {
      revisit = revisit || (frames[k].keyframe && views.At(q, k) >= kSame);
    }
    answers.revisits += revisit;
    if (last >= 0) {
      const std::pair<int, double> found = best(q, last);
      if (found.first >= 0) {
        answers.best_first.push_back({found.second, views.At(q, found.first)});
      }
    }
    if (frames[q].keyframe) add(q);
  }
  std::stable_sort(answers.best_first.begin(), answers.best_first.end(),
                   [](const Answer& a, const Answer& b) { return a.score > b.score; });
  return answers;
}

Answers AskIndex(const std::vector<PosedFrame>& frames, const SharedViews& views) {
  PlaceIndex index;
  const auto best = [&](int q, int last) -> std::pair<int, double> {
    const auto earlier = [last](KeyFrameId id) { return static_cast<int>(id.value) <= last; };
    const std::vector<PlaceMatch> found = index.Query(*frames[q].frame, earlier, 1);
    if (found.empty()) return {-1, 0};
    return {static_cast<int>(found[0].id.value), found[0].score};
  };
  return Ask(frames, views, best,
             [&](int q) { index.Add({static_cast<uint32_t>(q)}, frames[q].frame); });
}

Answers AskBruteForce(const std::vector<PosedFrame>& frames, const SharedViews& views) {
  const auto best = [&](int q, int last) -> std::pair<int, double> {
    std::pair<int, double> found{-1, 0};
    for (int k = 0; k <= last; ++k) {
      if (!frames[k].keyframe) continue;
      const size_t matches = MatchBruteForce(*frames[q].frame, *frames[k].frame).size();
      if (static_cast<double>(matches) > found.second) found = {k, static_cast<double>(matches)};
    }
    return found;
  };
  return Ask(frames, views, best, [](int) {});
}

Table PrecisionTable(const Recording& recording, const std::vector<PosedFrame>& frames,
                     const SharedViews& views) {
  const Answers ours = AskIndex(frames, views), theirs = AskBruteForce(frames, views);
  const auto keyframes = std::count_if(frames.begin(), frames.end(),
                                       [](const PosedFrame& frame) { return frame.keyframe; });
  Table table;
  table.name = "precision at a recall, by what share of the view a wrong answer has at most: " +
               std::to_string(ours.revisits) + " of " + std::to_string(views.size()) +
               " frames are revisits of " + std::to_string(keyframes) + " keyframes";
  const std::vector<double> recalls = {0.1, 0.2, 0.3,  0.4, 0.5,  0.6,
                                       0.7, 0.8, 0.85, 0.9, 0.95, 1.0};
  for (const double recall : recalls) {
    char name[40];
    std::snprintf(name, sizeof name, "precision_at_recall_%g", recall);
    table.columns.push_back({name});
  }
  table.columns.push_back({"recall_without_errors"});
  for (const double wrong : {kSame, kElsewhere}) {
    const std::string share = std::to_string(std::lround(100 * wrong)) + " %";
    for (const Answers* answers : {&ours, &theirs}) {
      Case of{(answers == &ours ? "index, " : "all pairs, ") + share};
      of.source = recording.source;
      of.frames = views.size();
      std::vector<double> values;
      for (const double recall : recalls) values.push_back(PrecisionAt(*answers, recall, wrong));
      values.push_back(RecallWithoutErrors(*answers, wrong));
      table.lines.push_back({std::move(of), std::move(values)});
    }
  }
  return table;
}

// As many as asked for: those given, then copies whose descriptors have 24 bits drawn and flipped.
std::vector<PlaceKeyFrame> Multiply(const std::vector<PosedFrame>& frames, int count) {
  Random random(1);
  std::vector<PlaceKeyFrame> many;
  for (int i = 0; i < count; ++i) {
    auto frame = std::make_shared<Frame>(*frames[i % frames.size()].frame);
    if (i >= static_cast<int>(frames.size())) {
      for (Descriptor& d : frame->descriptors) {
        for (int flip = 0; flip < 24; ++flip) {
          const uint32_t bit = random.Below(256);
          d.words[bit / 64] ^= uint64_t{1} << (bit % 64);
        }
      }
    }
    many.emplace_back(KeyFrameId{static_cast<uint32_t>(i)}, std::move(frame));
  }
  return many;
}

std::string MemoryOf(const PlaceIndex& index, const std::vector<PlaceKeyFrame>& keyframes) {
  size_t descriptors = 0;
  for (const PlaceKeyFrame& keyframe : keyframes) {
    descriptors += keyframe.second->descriptors.size() * sizeof(Descriptor);
  }
  const auto each = [&](size_t bytes) {
    return static_cast<double>(bytes) / static_cast<double>(keyframes.size()) * 1e-3;
  };
  char text[96];
  std::snprintf(text, sizeof text, "%.1f KB each, with descriptors %.1f KB",
                each(index.MemoryBytes()), each(index.MemoryBytes() + descriptors));
  return text;
}

}  // namespace

Section BenchPlace(const Recording& recording) {
  const std::vector<PosedFrame> frames = TakeFrames(recording);
  const std::vector<PlaceKeyFrame> many = Multiply(frames, kMany);
  const std::vector<PlaceKeyFrame> all_but_one(many.begin(), many.end() - 1);
  PlaceIndex index, growing;
  std::vector<double> growth;
  for (int turn = 0; turn < 5; ++turn) {
    const Stopwatch watch;
    index.Restore({}, many);
    growth.push_back(watch.Milliseconds());
  }
  growing.Restore(index.Save(), all_but_one);
  const auto frame = [&](int turn) -> const Frame& {
    return *frames[static_cast<size_t>(turn) % frames.size()].frame;
  };
  const std::string of = "of " + std::to_string(kMany) + " keyframes";
  Section section =
      TakeTurns("place", recording,
                {{"query " + of, [&](int turn) { index.Query(frame(turn), {}, 5); }, 1,
                  MemoryOf(index, many)},
                 {"score of one keyframe",
                  [&](int turn) { index.Score(frame(turn), {static_cast<uint32_t>(turn)}); }, 1},
                 {"adding a keyframe and taking it out",
                  [&](int) {
                    growing.Add(many.back().first, many.back().second);
                    growing.Remove(many.back().first);
                  },
                  1},
                 {"matching all against all, one pair",
                  [&](int turn) { MatchBruteForce(frame(turn), frame(turn + 1)); }, 1}},
                40);
  const double cpu_start = ProcessCpuSeconds();
  for (int turn = 0; turn < 40; ++turn) index.Query(frame(turn), {}, 5);
  section.timings.push_back(TimingOf("query " + of + ", CPU time", recording,
                                     {(ProcessCpuSeconds() - cpu_start) * 1e3 / 40},
                                     "mean of 40, one after the other"));
  section.timings.push_back(TimingOf("growing vocabulary and index " + of, recording, growth,
                                     std::to_string(index.Save().nodes.size()) + " nodes"));
  section.tables.push_back(
      PrecisionTable(recording, frames, SharedViews(frames, recording.info.camera)));
  return section;
}

}  // namespace alidade::bench
