#include "alidade/features/extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/features/corners.h"
#include "alidade/features/pyramid.h"

namespace alidade {
namespace {

// Rows of a level that one thread looks through at a time; keypoints it describes at a time.
constexpr int kBandRows = 96;
constexpr int kChunk = 64;

// How many keypoints each level gets: shares fall with the level's side (1 / 1.2), and what a level
// cannot fill goes to the others in the same proportion.
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

}  // namespace

void ExtractorSettings::Check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) ThrowUsage(std::string("extractor: ") + what);
  };
  require(features >= 1, "features must be at least 1");
  require(fast_minimum >= 1 && fast_minimum <= 255, "fast_minimum must be from 1 to 255");
  require(fast_threshold >= fast_minimum && fast_threshold <= 255,
          "fast_threshold must be from fast_minimum to 255");
  require(cell >= 8, "cell must be at least 8 pixels");
  require(border >= kPatternReach + 1, "border must be at least 17 pixels");
}

Extractor::Extractor(ExtractorSettings settings) : settings_(settings) { settings_.Check(); }

Frame Extractor::Extract(const cv::Mat& image, const Camera& camera, double time, int number) {
  if (image.type() != CV_8UC1) ThrowUsage("extractor: the image must be 8 bit grey");
  if (image.cols != camera.width || image.rows != camera.height) {
    ThrowUsage("extractor: the image is " + std::to_string(image.cols) + "x" +
               std::to_string(image.rows) + ", the camera " + std::to_string(camera.width) + "x" +
               std::to_string(camera.height));
  }
  Frame frame;
  frame.time = time;
  frame.number = number;
  frame.image = image.clone();  // the caller may reuse the buffer
  frame.pyramid = BuildPyramid(frame.image);

  // Corners in bands of rows, and the smoothed levels.
  struct Band {
    int level, first_row, end_row;
  };
  std::vector<Band> bands;
  std::array<int, kPyramidLevels + 1> first_band{};
  std::array<int, kPyramidLevels + 1> first_smooth_row{};
  for (int l = 0; l < kPyramidLevels; ++l) {
    first_band[l] = static_cast<int>(bands.size());
    for (int row = 0; row < frame.pyramid[l].rows; row += kBandRows) {
      bands.push_back({l, row, row + kBandRows});
    }
    first_smooth_row[l + 1] = first_smooth_row[l] + frame.pyramid[l].rows;
  }
  first_band[kPyramidLevels] = static_cast<int>(bands.size());
  smooth_.create(first_smooth_row[kPyramidLevels], image.cols, CV_8UC1);
  const int stride = static_cast<int>(smooth_.step[0]);
  if (!pattern_ || pattern_->stride() != stride) pattern_.emplace(stride);
  std::array<cv::Mat, kPyramidLevels> smooth;
  for (int l = 0; l < kPyramidLevels; ++l) {
    smooth[l] =
        smooth_(cv::Rect(0, first_smooth_row[l], frame.pyramid[l].cols, frame.pyramid[l].rows));
  }
  std::vector<std::vector<Corner>> found(bands.size());
  ParallelFor(kPyramidLevels + static_cast<int>(bands.size()), [&](int i) {
    if (i < kPyramidLevels) {
      SmoothForDescriptors(frame.pyramid[i], smooth[i]);
    } else {
      const Band& band = bands[i - kPyramidLevels];
      found[i - kPyramidLevels] = FastCorners(frame.pyramid[band.level], settings_.fast_minimum,
                                              settings_.border, band.first_row, band.end_row);
    }
  });

  // The choice among them, level by level.
  std::array<std::vector<Corner>, kPyramidLevels> corners;
  ParallelFor(kPyramidLevels, [&](int l) {
    std::vector<Corner> all;
    for (int b = first_band[l]; b < first_band[l + 1]; ++b) {
      all.insert(all.end(), found[b].begin(), found[b].end());
    }
    corners[l] = StrongPerCell(all, frame.pyramid[l].size(), settings_.border, settings_.cell,
                               settings_.fast_threshold);
  });
  std::array<int, kPyramidLevels> available{};
  for (int l = 0; l < kPyramidLevels; ++l) available[l] = static_cast<int>(corners[l].size());
  const std::array<int, kPyramidLevels> budget = LevelBudgets(available, settings_.features);
  ParallelFor(kPyramidLevels, [&](int l) {
    corners[l] = SpreadCorners(corners[l], frame.pyramid[l].size(), budget[l]);
  });

  // Direction, descriptor and position of each.
  std::array<int, kPyramidLevels + 1> first{};
  for (int l = 0; l < kPyramidLevels; ++l) {
    first[l + 1] = first[l] + static_cast<int>(corners[l].size());
  }
  const int count = first[kPyramidLevels];
  frame.keypoints.resize(count);
  frame.descriptors.resize(count);
  const bool distorted = camera.HasDistortion();
  ParallelFor((count + kChunk - 1) / kChunk, [&](int chunk) {
    int l = 0;
    for (int i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
      while (i >= first[l + 1]) ++l;
      const Corner& corner = corners[l][i - first[l]];
      Keypoint& k = frame.keypoints[i];
      k.level = l;
      k.response = static_cast<float>(corner.score);
      k.angle = PatchAngle(frame.pyramid[l], corner.x, corner.y);
      frame.descriptors[i] =
          pattern_->Describe(smooth[l].ptr<uint8_t>(corner.y) + corner.x, k.angle);
      const double scale_x = static_cast<double>(image.cols) / frame.pyramid[l].cols;
      const double scale_y = static_cast<double>(image.rows) / frame.pyramid[l].rows;
      const Eigen::Vector2d raw(ToLevelZero(corner.x, scale_x), ToLevelZero(corner.y, scale_y));
      const Eigen::Vector2d ideal = distorted ? camera.Undistort(raw) : raw;
      k.raw_x = static_cast<float>(raw.x());
      k.raw_y = static_cast<float>(raw.y());
      k.x = static_cast<float>(ideal.x());
      k.y = static_cast<float>(ideal.y());
    }
  });
  frame.grid = KeypointGrid(frame.keypoints, camera.width, camera.height);
  return frame;
}

}  // namespace alidade
