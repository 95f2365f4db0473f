#include "alidade/run/sources/pair_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "alidade/base/median.h"
#include "alidade/features/extractor.h"
#include "alidade/features/matching.h"

namespace alidade {
namespace {

constexpr int kPairs = 16;
constexpr int kMostDelay = 8;        // frames, either way
constexpr int kLeastMatches = 30;    // of a pair
constexpr double kRowNoise = 1.5;    // pixels of the keypoint's level, three standard deviations
constexpr double kUsualShare = 0.7;  // of matches that agree, in a sound pair; wrong matches do not
constexpr double kMostWrong = 0.1;   // share of matches with a wrong disparity, in a sound pair
constexpr double kMostUnusual = 0.25;  // share of the pairs with fewer, in a sound recording
constexpr double kDelayGain = 1.25;

struct RowOffset {
  double row;    // right minus left, pixels
  double noise;  // three standard deviations, pixels
};

// Counts of matches, of one pair or of several.
struct PairMatches {
  int count = 0;
  int in_row = 0;                   // corresponding rows agree
  int forwards = 0, backwards = 0;  // of these: the right camera's lies to the left, or the right
  int in_column = 0;                // columns agree, rows do not
  std::vector<RowOffset> rows;
  int sound() const { return in_row - backwards; }
  void Add(const PairMatches& other) {
    count += other.count;
    in_row += other.in_row;
    forwards += other.forwards;
    backwards += other.backwards;
    in_column += other.in_column;
    rows.insert(rows.end(), other.rows.begin(), other.rows.end());
  }
  bool usual() const { return in_row >= kUsualShare * count && backwards <= kMostWrong * in_row; }
};

class PairReader {
 public:
  explicit PairReader(FrameSource& source) : source_(source), extractor_(Settings()) {}

  std::optional<Frame> Left(int index) { return Features(index, &SourceFrame::image); }
  std::optional<Frame> Right(int index) { return Features(index, &SourceFrame::right); }

 private:
  static ExtractorSettings Settings() {
    ExtractorSettings settings;
    settings.features = 500;
    return settings;
  }

  std::optional<Frame> Features(int index, cv::Mat SourceFrame::*which) {
    if (index < 0 || index >= source_.Info().frames) return std::nullopt;
    if (index != index_) {
      if (!source_.Seek(index)) return std::nullopt;
      frame_ = source_.Next();
      index_ = index;
    }
    if (!frame_ || ((*frame_).*which).empty()) return std::nullopt;
    return extractor_.Extract((*frame_).*which, source_.Info().camera, 0, index);
  }

  FrameSource& source_;
  Extractor extractor_;
  std::optional<SourceFrame> frame_;
  int index_ = -1;
};

PairMatches Compare(const Frame& left, const Frame& right) {
  PairMatches result;
  for (const IndexMatch& match : MatchBruteForce(left, right)) {
    const Keypoint& a = left.keypoints[static_cast<size_t>(match.a)];
    const Keypoint& b = right.keypoints[static_cast<size_t>(match.b)];
    const double noise = kRowNoise * ScaleOfLevel(std::max(a.level, b.level));
    const double row = b.y - a.y, disparity = a.x - b.x;
    ++result.count;
    result.rows.push_back({row, noise});
    if (std::abs(row) <= noise) {
      ++result.in_row;
      result.forwards += disparity > noise;
      result.backwards += disparity < -noise;
    } else if (std::abs(disparity) <= noise) {
      ++result.in_column;
    }
  }
  return result;
}

// The delay, in frames, at which most matches agree.
int DelayOf(PairReader& reader, const std::vector<int>& indices) {
  std::vector<double> sound(2 * kMostDelay + 1, 0);
  for (const int index : indices) {
    const std::optional<Frame> left = reader.Left(index);
    if (!left) continue;
    for (int delay = -kMostDelay; delay <= kMostDelay; ++delay) {
      // A right image that is late shows what the left one showed before.
      const std::optional<Frame> right = reader.Right(index + delay);
      if (right) sound[static_cast<size_t>(delay + kMostDelay)] += Compare(*left, *right).sound();
    }
  }
  const auto best = std::max_element(sound.begin(), sound.end());
  const int delay = static_cast<int>(best - sound.begin()) - kMostDelay;
  return *best > kDelayGain * sound[kMostDelay] ? delay : 0;
}

}  // namespace

PairVerdict CheckPairs(FrameSource& source) {
  PairVerdict verdict;
  const int frames = source.Info().frames;
  if (frames <= 0 || !source.Seek(0)) return verdict;
  PairReader reader(source);
  PairMatches all;
  std::vector<int> unusual;
  for (int k = 0; k < std::min(kPairs, frames); ++k) {
    const int index = static_cast<int>((2LL * k + 1) * frames / (2 * std::min(kPairs, frames)));
    const std::optional<Frame> left = reader.Left(index), right = reader.Right(index);
    if (!left || !right) continue;
    const PairMatches pair = Compare(*left, *right);
    if (pair.count < kLeastMatches) continue;
    ++verdict.pairs;
    all.Add(pair);
    if (!pair.usual()) unusual.push_back(index);
  }
  if (static_cast<double>(unusual.size()) <= kMostUnusual * verdict.pairs) return verdict;
  if (all.in_row >= kUsualShare * all.count && all.backwards > all.forwards) {
    verdict.fault = PairFault::kSwapped;
    return verdict;
  }
  if (all.in_column >= kUsualShare * all.count) {
    verdict.fault = PairFault::kStacked;
    return verdict;
  }
  // The same distance of the rows at all times and places is the calibration's.
  std::vector<double> rows;
  for (const RowOffset& offset : all.rows) rows.push_back(offset.row);
  const double usual_row = UpperMedian(rows);
  const auto same = std::count_if(all.rows.begin(), all.rows.end(), [&](const RowOffset& offset) {
    return std::abs(offset.row - usual_row) <= offset.noise;
  });
  if (static_cast<double>(same) < kUsualShare * all.count) verdict.delay = DelayOf(reader, unusual);
  if (verdict.delay != 0) {
    verdict.fault = PairFault::kDelayed;
  } else if (!all.usual()) {
    verdict.fault = PairFault::kRowsOff;
    for (double& row : rows) row = std::abs(row);
    verdict.rows = UpperMedian(rows);
  }
  return verdict;
}

std::string PairInWords(const PairVerdict& verdict) {
  switch (verdict.fault) {
    case PairFault::kNone:
      return "";
    case PairFault::kSwapped:
      return "the left and right images are swapped";
    case PairFault::kStacked:
      return "the second camera lies above or below the first one, not beside it";
    case PairFault::kDelayed:
      return "the right images are " + std::to_string(std::abs(verdict.delay)) +
             (std::abs(verdict.delay) == 1 ? " frame " : " frames ") +
             (verdict.delay > 0 ? "late" : "early");
    case PairFault::kRowsOff:
      return "corresponding points of the left and right images lie " +
             std::to_string(std::lround(verdict.rows)) +
             " rows apart: the calibration does not fit this pair, or the images were not taken "
             "together";
  }
  return "";
}

}  // namespace alidade
