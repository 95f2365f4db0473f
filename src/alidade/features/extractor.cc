#include "alidade/features/extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/base/part_times.h"
#include "alidade/base/settings_table.h"
#include "alidade/features/pyramid.h"
#include "alidade/features/smooth.h"
#include "alidade/features/spread.h"

namespace alidade {
namespace {

constexpr int kBandCells = 3;  // rows of cells per task
constexpr int kChunk = 64;     // keypoints described per task
// Of the usual density in avoided regions: enough to detect motion there.
constexpr double kAvoidedShare = 0.4;
constexpr int kAround = 4;  // rows that FAST needs above and below

// Number of keypoints per level: proportional to the level's side length. What a level cannot fill
// is distributed to the others in the same proportion.
std::array<int, kPyramidLevels> LevelBudgets(const std::array<int, kPyramidLevels>& available,
                                             int total) {
  std::array<int, kPyramidLevels> budget{};
  std::array<bool, kPyramidLevels> full{};
  for (bool changed = true; changed;) {
    changed = false;
    double shares = 0;
    int left = total;
    for (int l = 0; l < kPyramidLevels; ++l) {
      if (full[l])
        left -= available[l];
      else
        shares += 1 / ScaleOfLevel(l);
    }
    for (int l = 0; l < kPyramidLevels; ++l) {
      if (full[l]) continue;
      budget[l] = static_cast<int>(std::lround(left / shares / ScaleOfLevel(l)));
      if (available[l] <= budget[l]) {
        budget[l] = available[l];
        full[l] = changed = true;
      }
    }
  }
  return budget;
}

// Sum of the proportions of all levels.
double ScaleSum() {
  double sum = 0;
  for (int l = 0; l < kPyramidLevels; ++l) sum += 1 / ScaleOfLevel(l);
  return sum;
}

// Removes the corners where `avoid` is nonzero from `corners` and returns them.
std::vector<Corner> TakeAvoided(std::vector<Corner>& corners, cv::Size level,
                                const cv::Mat& avoid) {
  std::vector<Corner> avoided, useful;
  for (const Corner& corner : corners) {
    const int x = corner.x * avoid.cols / level.width, y = corner.y * avoid.rows / level.height;
    (avoid.at<uint8_t>(y, x) ? avoided : useful).push_back(corner);
  }
  corners = std::move(useful);
  return avoided;
}

// All rows of all levels, cut at multiples of kBandCells rows of cells.
std::vector<Extractor::Band> CutIntoBands(const std::vector<cv::Size>& sizes,
                                          const ExtractorSettings& settings) {
  std::vector<Extractor::Band> bands;
  for (int l = 0; l < static_cast<int>(sizes.size()); ++l) {
    const int rows = sizes[l].height, step = kBandCells * settings.cell;
    for (int row = 0, end; row < rows; row = end) {
      end = std::min(rows, row == 0 ? settings.border + step : row + step);
      bands.push_back({l, row, end});
    }
  }
  return bands;
}

}  // namespace

std::span<const Setting> ExtractorSettings::Table() {
  using T = ExtractorSettings;
  static constexpr Setting kRows[] = {
      // At most 100 times the usual number: beyond, nearly every pixel would be a keypoint.
      PublicSetting<&T::features>("tracker.extractor.features", FromTo(1, 100000), "",
                                  "Keypoints wanted per image."),
      PublicSetting<&T::fast_threshold>(
          "tracker.extractor.fast_threshold", FromTo(1, 255), "gray levels",
          "Contrast of a FAST corner; less finds corners in dim or blurred images."),
      ExpertSetting<&T::min_fast_threshold>(
          "tracker.extractor.min_fast_threshold", FromTo(1, 255), "gray levels",
          "The same in the second attempt, in cells where the first found none."),
      ExpertSetting<&T::cell>("tracker.extractor.cell", FromTo(8, 10000), "px",
                              "Side of a detection cell on every level."),
  };
  return kRows;
}

void ExtractorSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(what);
  };
  CheckRanges(*this);
  require(fast_threshold >= min_fast_threshold,
          "setting tracker.extractor.fast_threshold must be at least "
          "expert.tracker.extractor.min_fast_threshold");
  require(border >= kPatternReach + 1, "ExtractorSettings::border must be at least 19 pixels");
  require(evenness >= 0 && evenness <= 1, "ExtractorSettings::evenness must be from 0 to 1");
}

Extractor::Extractor(ExtractorSettings settings) : settings_(settings) { settings_.Check(); }

void Extractor::PrepareBuffers(const std::vector<cv::Size>& sizes) {
  if (!smooth_.empty() && smooth_[0].size() == sizes[0]) return;
  int rows = 0;
  for (const cv::Size& size : sizes) rows += size.height;
  const cv::Mat fine(rows, sizes[0].width, CV_8UC1), smooth(rows, sizes[0].width, CV_8UC1);
  std::vector<cv::Mat> fine_levels, smooth_levels;
  int first_row = 0;
  for (const cv::Size& size : sizes) {
    const cv::Rect place(0, first_row, size.width, size.height);
    fine_levels.push_back(fine(place));
    smooth_levels.push_back(smooth(place));
    first_row += size.height;
  }
  pattern_.emplace(static_cast<int>(smooth.step[0]));
  // Assigned only after all allocations succeeded, so that bad_alloc leaves the buffers consistent.
  fine_ = std::move(fine_levels);
  smooth_ = std::move(smooth_levels);
}

// `fine`: the level smoothed a little from row `top` on. Of the band the same, and the level
// smoothed more, are kept.
void Extractor::Smooth(const cv::Mat& level, const Band& band, int top, cv::Mat& fine) {
  const PartTimer timer(FramePart::kSmooth);
  SmoothBinomial(level, top, fine);
  fine.rowRange(band.first_row - top, band.end_row - top)
      .copyTo(fine_[band.level].rowRange(band.first_row, band.end_row));
  SmoothBox(fine, band.first_row - top, smooth_[band.level].rowRange(band.first_row, band.end_row));
}

std::vector<Corner> Extractor::LookThrough(const cv::Mat& level, const Band& band) {
  // The neighboring bands' rows that this band needs are smoothed again, which is cheaper than
  // synchronizing.
  const int top = std::max(0, band.first_row - kAround);
  const int bottom = std::min(level.rows, band.end_row + kAround);
  cv::Mat fine(bottom - top, level.cols, CV_8UC1);
  Smooth(level, band, top, fine);

  const PartTimer timer(FramePart::kCorners);
  const int first = std::max(band.first_row, settings_.border);
  const int end = std::min(band.end_row, level.rows - settings_.border);
  std::vector<Corner> corners =
      FastCorners(fine, settings_.min_fast_threshold, settings_.border, first - top, end - top);
  for (Corner& c : corners) c.y += top;
  return StrongPerCell(corners, level.size(), settings_.border, settings_.cell,
                       settings_.fast_threshold);
}

Frame Extractor::ExtractFrom(const cv::Mat& image, const Camera& camera, double time, int number,
                             const cv::Mat& avoid, bool reuse) {
  if (image.type() != CV_8UC1) ThrowUsage("extractor: the image must be 8-bit gray");
  if (image.cols != camera.width || image.rows != camera.height) {
    ThrowUsage("extractor: the image is " + std::to_string(image.cols) + "x" +
               std::to_string(image.rows) + ", the camera " + std::to_string(camera.width) + "x" +
               std::to_string(camera.height));
  }
  const PartTimer whole_timer(FramePart::kBuffers);
  Frame frame;
  frame.time = time;
  frame.number = number;
  frame.image = image;
  const std::vector<cv::Size> sizes = PyramidSizes(frame.image.size());
  PrepareBuffers(sizes);

  // Corners and smoothed levels, in bands of rows. Task 0 builds the smaller levels meanwhile.
  const std::vector<Band> bands = CutIntoBands(sizes, settings_);
  std::vector<std::vector<Corner>> found(bands.size());
  const int of_level_0 = static_cast<int>(
      std::count_if(bands.begin(), bands.end(), [](const Band& b) { return b.level == 0; }));
  ParallelFor(1 + of_level_0, [&](int i) {
    if (i == 0)
      frame.pyramid = BuildPyramid(frame.image, std::move(pyramid_));
    else
      found[i - 1] = LookThrough(frame.image, bands[i - 1]);
  });
  ParallelFor(static_cast<int>(bands.size()) - of_level_0, [&](int i) {
    const Band& band = bands[of_level_0 + i];
    found[of_level_0 + i] = LookThrough(frame.pyramid[band.level], band);
  });

  if (reuse) {
    pyramid_ = frame.pyramid;
    pyramid_[0].release();
  }

  // Select corners level by level.
  std::array<std::vector<Corner>, kPyramidLevels> corners;
  for (size_t b = 0; b < bands.size(); ++b) {
    std::vector<Corner>& all = corners[bands[b].level];
    all.insert(all.end(), found[b].begin(), found[b].end());
  }
  std::array<std::vector<Corner>, kPyramidLevels> avoided;
  if (!avoid.empty()) {
    for (int l = 0; l < kPyramidLevels; ++l) avoided[l] = TakeAvoided(corners[l], sizes[l], avoid);
  }
  std::array<int, kPyramidLevels> available{};
  for (int l = 0; l < kPyramidLevels; ++l) available[l] = static_cast<int>(corners[l].size());
  const std::array<int, kPyramidLevels> budget = LevelBudgets(available, settings_.features);
  ParallelFor(kPyramidLevels, [&](int l) {
    const PartTimer timer(FramePart::kSpread);
    const size_t useful = corners[l].size();
    corners[l] = SpreadCorners(corners[l], sizes[l], budget[l], settings_.evenness);
    if (avoided[l].empty()) return;
    const double share =
        static_cast<double>(avoided[l].size()) / static_cast<double>(avoided[l].size() + useful);
    const int few =
        static_cast<int>(kAvoidedShare * share * settings_.features / ScaleOfLevel(l) / ScaleSum());
    const std::vector<Corner> rest = SpreadCorners(avoided[l], sizes[l], few, settings_.evenness);
    corners[l].insert(corners[l].end(), rest.begin(), rest.end());
    std::sort(corners[l].begin(), corners[l].end(),
              [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  });

  // Orientation, descriptor and position of each keypoint.
  std::array<int, kPyramidLevels + 1> first{};
  for (int l = 0; l < kPyramidLevels; ++l) {
    first[l + 1] = first[l] + static_cast<int>(corners[l].size());
  }
  const int count = first[kPyramidLevels];
  frame.keypoints.resize(count);
  frame.descriptors.resize(count);
  const bool distorted = camera.HasDistortion();
  ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
    const PartTimer timer(FramePart::kDescribe);
    int l = 0;
    for (int i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
      while (i >= first[l + 1]) ++l;
      const Corner& corner = corners[l][i - first[l]];
      Keypoint& k = frame.keypoints[i];
      k.level = l;
      k.response = static_cast<float>(corner.score);
      k.angle = PatchAngle(frame.pyramid[l], corner.x, corner.y);
      frame.descriptors[i] =
          pattern_->Describe(smooth_[l].ptr<uint8_t>(corner.y) + corner.x, k.angle);
      const Eigen::Vector2d place = RefineCorner(fine_[l], corner);
      const Eigen::Vector2d raw(
          ToLevelZero(place.x(), static_cast<double>(image.cols) / sizes[l].width),
          ToLevelZero(place.y(), static_cast<double>(image.rows) / sizes[l].height));
      const Eigen::Vector2d ideal = distorted ? camera.Undistort(raw) : raw;
      k.raw_x = static_cast<float>(raw.x());
      k.raw_y = static_cast<float>(raw.y());
      k.x = static_cast<float>(ideal.x());
      k.y = static_cast<float>(ideal.y());
    }
  });
  const PartTimer grid_timer(FramePart::kGrid);
  frame.grid = KeypointGrid(frame.keypoints, camera.width, camera.height);
  return frame;
}

}  // namespace alidade
