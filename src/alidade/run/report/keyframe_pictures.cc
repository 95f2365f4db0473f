#include "alidade/run/report/keyframe_pictures.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/base/print.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/map/depth_cloud.h"

namespace alidade {
namespace {

constexpr size_t kMostDrawn = 8;
constexpr int kQuality = 80;     // JPEG: 15 KB each
constexpr float kMoving = 0.5f;  // features with a lower static probability are drawn as moving
const cv::Scalar kMatched(232, 182, 31), kFree(202, 193, 185), kMoved(47, 58, 212);  // viewer.css

std::string Jpeg(const cv::Mat& picture) { return EncodeJpeg(picture, kQuality); }

cv::Mat InColor(const cv::Mat& image) {
  cv::Mat color;
  if (image.channels() == 3) return image.clone();
  cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
  return color;
}

cv::Mat WithFeatures(const KeyframeAlbum::Page& page) {
  cv::Mat picture = InColor(page.image);
  for (const bool matched : {false, true}) {  // matched ones on top
    for (const FeatureUse& feature : page.features) {
      if (feature.matched != matched) continue;
      const cv::Scalar& color = feature.static_probability < kMoving ? kMoved
                                : feature.matched                    ? kMatched
                                                                     : kFree;
      cv::circle(picture, cv::Point2f(feature.x, feature.y), 2, color, 1, cv::LINE_AA);
    }
  }
  return picture;
}

// Depth at pixels of the small image, meters or map units.
struct DepthDot {
  cv::Point2f at;
  float depth;
};

std::vector<DepthDot> DotsOf(const cv::Mat& depth, float unit, float smaller) {
  std::vector<DepthDot> dots;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float value = depth.type() == CV_16U   ? depth.at<uint16_t>(y, x) * unit
                          : depth.type() == CV_32F ? depth.at<float>(y, x)
                                                   : 0;
      if (value > 0)
        dots.push_back({{static_cast<float>(x) * smaller, static_cast<float>(y) * smaller}, value});
    }
  }
  return dots;
}

std::vector<DepthDot> DotsOf(const KeyFrame& keyframe, const MapSnapshot& map, float smaller) {
  std::vector<DepthDot> dots;
  for (size_t k = 0; k < keyframe.landmarks.size(); ++k) {
    const Landmark* landmark =
        keyframe.landmarks[k].valid() ? map.Find(keyframe.landmarks[k]) : nullptr;
    if (!landmark) continue;
    const Keypoint& keypoint = keyframe.frame->keypoints[k];
    const auto depth = static_cast<float>((keyframe.T_camera_world * landmark->p_world).z());
    if (depth > 0) dots.push_back({{keypoint.raw_x * smaller, keypoint.raw_y * smaller}, depth});
  }
  return dots;
}

// Draws depth on the darkened image, near bright and far dark (viridis). Returns the color range:
// the 5 % to 95 % quantiles.
std::pair<float, float> Paint(std::vector<DepthDot> dots, int radius, cv::Mat& picture) {
  std::sort(dots.begin(), dots.end(),
            [](const DepthDot& a, const DepthDot& b) { return a.depth > b.depth; });
  const auto rank = [&](double share) {
    return dots[static_cast<size_t>(share * static_cast<double>(dots.size() - 1))].depth;
  };
  const float far = rank(0.05), near = rank(0.95);
  cv::Mat levels(1, 256, CV_8U), palette;
  for (int i = 0; i < 256; ++i) levels.at<uint8_t>(0, i) = static_cast<uint8_t>(i);
  cv::applyColorMap(levels, palette, cv::COLORMAP_VIRIDIS);
  for (const DepthDot& dot : dots) {
    const float share = far > near ? (1 / dot.depth - 1 / far) / (1 / near - 1 / far) : 0.5f;
    const auto& color = palette.at<cv::Vec3b>(0, cv::saturate_cast<uint8_t>(255 * share));
    cv::circle(picture, dot.at, radius, cv::Scalar(color), cv::FILLED);
  }
  return {near, far};
}

std::string Words(const char* format, double a, double b = 0) {
  char text[64];
  PrintTo(text, sizeof(text), format, a, b);
  return text;
}

// The existing keyframes by the number of their frame.
std::map<int, const KeyFrame*> ByIndex(const MapSnapshot& map, int first_number) {
  std::map<int, const KeyFrame*> keyframes;
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame* keyframe = map.Find(id);
    keyframes[keyframe->frame->number - first_number] = keyframe;
  }
  return keyframes;
}

// All that can be shown alike: with semi-dense depth if any has it, else those that still exist,
// else all.
std::vector<const KeyframeAlbum::Page*> ShownPages(const KeyframeAlbum& album,
                                                   const std::map<int, const KeyFrame*>& living) {
  std::vector<const KeyframeAlbum::Page*> all, existing, dense;
  for (const KeyframeAlbum::Page& page : album.pages()) {
    all.push_back(&page);
    const auto found = living.find(page.index);
    if (found == living.end()) continue;
    existing.push_back(&page);
    if (found->second->depth && !found->second->depth->pixels.empty()) dense.push_back(&page);
  }
  return !dense.empty() ? dense : !existing.empty() ? existing : all;
}

}  // namespace

std::vector<ReportKeyframe> DrawKeyframes(const KeyframeAlbum& album, const RunResults& results,
                                          const Slam& slam, double start) {
  const Camera camera = slam.camera();
  const auto living = ByIndex(results.map, slam.first_number());
  const auto pages = ShownPages(album, living);
  const size_t count = std::min(kMostDrawn, pages.size());
  const float smaller = static_cast<float>(KeyframeAlbum::kWide) / static_cast<float>(camera.width);
  std::vector<ReportKeyframe> drawn;
  for (size_t i = 0; i < count; ++i) {
    const KeyframeAlbum::Page& page = *pages[i * pages.size() / count];
    const auto found = living.find(page.index);
    const KeyFrame* keyframe = found == living.end() ? nullptr : found->second;
    std::vector<DepthDot> dots;
    int radius = 1;
    const char* from = "";
    if (keyframe && keyframe->depth && !keyframe->depth->pixels.empty()) {
      dots = DotsOf(DrawDepth(*keyframe->depth, PlaceDepth(*keyframe).scale, camera),
                    static_cast<float>(1 / kDepthPictureFactor), smaller);
      from = "semi-dense depth";
    } else if (!page.depth.empty() && camera.depth_factor > 0) {
      dots = DotsOf(page.depth, static_cast<float>(1 / camera.depth_factor), 1);
      from = "depth of the sensor";
    } else if (keyframe) {
      dots = DotsOf(*keyframe, results.map, smaller);
      radius = 3;
      from = "depth of the landmarks";
    }
    ReportKeyframe shown;
    shown.caption =
        Words("%.2f s: ", page.time - start) + std::to_string(page.features.size()) + " features";
    shown.features = {shown.caption, "image/jpeg", Jpeg(WithFeatures(page))};
    if (!dots.empty()) {
      cv::Mat picture = InColor(page.image) * 0.35;
      const auto [near, far] = Paint(std::move(dots), radius, picture);
      const std::string words =
          from + Words(", %.2g to %.2g ", near, far) +
          (slam.camera().depth_factor > 0 || slam.camera().baseline > 0 ? "m" : "map units");
      shown.caption += "; " + words;
      shown.depth = {words, "image/jpeg", Jpeg(picture)};
    }
    drawn.push_back(std::move(shown));
  }
  return drawn;
}

}  // namespace alidade
