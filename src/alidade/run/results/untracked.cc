#include "alidade/run/results/untracked.h"

#include <algorithm>
#include <map>

#include "alidade/base/print.h"
#include "alidade/tracking/track_failure.h"

namespace alidade {
namespace {

constexpr double kBeginning = 1;    // seconds at the start of a loss that show its cause
constexpr double kShare = 1.0 / 3;  // share of these frames that must have the same condition
constexpr double kLong = 2;         // seconds after which advice for relocalization is added

const char* WordsFor(Look look) {
  switch (look) {
    case Look::kDark:
      return "the image was dark. Use more light";
    case Look::kBlurred:
      return "the image was blurred. Move more slowly, or use more light";
    case Look::kBare:
      return "the image had no texture, as in front of a bare wall. Keep something with texture in "
             "view";
    case Look::kOrdinary:
      break;
  }
  return "";
}

std::string Seconds(double value) {
  char text[32];
  PrintTo(text, sizeof(text), "%.2f s", value);
  return text;
}

// The spans of frames within a time interval, cut to it.
std::vector<UntrackedFrames> Within(const std::vector<UntrackedFrames>& all, double from,
                                    double to) {
  std::vector<UntrackedFrames> within;
  for (UntrackedFrames some : all) {
    if (some.to < from || some.from > to) continue;
    const double length = some.to - some.from;
    some.from = std::max(some.from, from);
    some.to = std::min(some.to, to);
    if (length > 0)
      some.frames = std::max(1, static_cast<int>(some.frames * (some.to - some.from) / length));
    within.push_back(std::move(some));
  }
  return within;
}

// The most frequent condition other than ordinary, if it is frequent enough.
Look LookOf(const std::vector<UntrackedFrames>& frames) {
  std::map<Look, int> counts;
  int all = 0;
  for (const UntrackedFrames& some : frames) {
    counts[some.look] += some.frames;
    all += some.frames;
  }
  counts.erase(Look::kOrdinary);
  const auto most =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most != counts.end() && most->second >= kShare * all ? most->first : Look::kOrdinary;
}

std::string MostFrequentReason(const std::vector<UntrackedFrames>& frames) {
  std::map<std::string, int> counts;
  for (const UntrackedFrames& some : frames) counts[some.reason] += some.frames;
  const auto most =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? "" : most->first;
}

}  // namespace

std::string AdviceOn(const std::string& reason) {
  return AdviceText(FailureWithReason(reason.c_str()));
}

void UntrackedLog::AddKeyFrame(const cv::Mat& gray) {
  Tracked();
  if (gray.empty() || gray.type() != CV_8UC1) return;
  blur_ += BlurOf(gray);
  ++sharp_;
}

void UntrackedLog::Add(double time, const std::string& reason, const cv::Mat& gray,
                       double corners) {
  const Look look = alidade::LookOf(gray, corners, sharp_ > 0 ? blur_ / sharp_ : kUsualBlur, look_);
  if (!going_on_ || all_.back().reason != reason || all_.back().look != look)
    all_.push_back({time, time, reason, look, 0});
  going_on_ = true;
  all_.back().to = time;
  ++all_.back().frames;
}

std::vector<std::string> LostInWords(const std::vector<std::array<double, 2>>& spans,
                                     const std::vector<UntrackedFrames>& untracked, double start) {
  std::vector<std::string> lines;
  for (const auto& [from, to] : spans) {
    const std::vector<UntrackedFrames> frames = Within(untracked, from, to);
    const Look look = LookOf(Within(frames, from, from + kBeginning));
    std::string line = Seconds(from - start) + " to " + Seconds(to - start) + ": ";
    if (frames.empty()) {
      line += "the map of this part was wrong and was dropped";
    } else if (look != Look::kOrdinary) {
      line += WordsFor(look);
    } else if (frames.front().reason == "too few landmarks found") {
      line +=
          "too few landmarks of the map were found: a fast rotation, or an occlusion. Move more "
          "slowly";
    } else {
      line += frames.front().reason;
      if (const std::string advice = AdviceOn(frames.front().reason); !advice.empty())
        line += ". " + advice;
    }
    if (to - from > kLong && frames.size() > 1 &&
        MostFrequentReason(frames) == "the place was not recognized") {
      line +=
          ". It stayed lost because the place was not recognized: return to a place and viewing "
          "direction that the camera had before";
    }
    lines.push_back(line + ".");
  }
  return lines;
}

std::string StartInWords(const std::vector<UntrackedFrames>& untracked, double start,
                         double until) {
  const std::vector<UntrackedFrames> frames = Within(untracked, start, start + until);
  if (frames.empty()) return "";
  if (const Look look = LookOf(frames); look != Look::kOrdinary) return WordsFor(look);
  const std::string reason = MostFrequentReason(frames), advice = AdviceOn(reason);
  return advice.empty() ? reason : reason + ". " + advice;
}

}  // namespace alidade
