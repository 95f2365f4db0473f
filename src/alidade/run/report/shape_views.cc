#include "alidade/run/report/shape_views.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "alidade/base/memory.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/run/results/semidense_outputs.h"
#include "alidade/view/cloud_picture.h"

namespace alidade {
namespace {

constexpr int kJpegQuality = 88;  // a third of the bytes of a PNG, and the dots stay dots

constexpr std::pair<CloudView, const char*> kViews[] = {
    {CloudView::kBehind, "from behind the first camera"},
    {CloudView::kFront, "in the direction of the first camera"},
    {CloudView::kSide, "from the right"},
    {CloudView::kAbove, "from above"}};

// About one pixel in an image of most of the cloud.
double PixelOf(const Cloud& cloud) {
  constexpr double kPixels = 800, kLeftOut = 0.03;
  Eigen::Vector3d size;
  std::vector<float> along(cloud.points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < along.size(); ++i) along[i] = cloud.points[i][axis];
    const auto rank = [&](double share) {
      const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(along.size() - 1));
      std::nth_element(along.begin(), along.begin() + at, along.end());
      return along[static_cast<size_t>(at)];
    };
    size[axis] = rank(1 - kLeftOut) - rank(kLeftOut);
  }
  return size.norm() / kPixels;
}

}  // namespace

ShapeViews WriteShapeViews(OutputFolder& folder, const RunResults& results, const Camera& camera,
                           const Cloud& cloud, double voxel) {
  // With few requested points, or a large map unit, the image still shows the place; and no image
  // needs every pixel of every keyframe.
  const double pixel = PixelOf(cloud);
  CloudScene scene = {voxel > 0 && voxel <= pixel
                          ? cloud
                          : MakeDepthCloud(DepthOf(results, results.maps.front()), camera, pixel),
                      PathOf(results), results.maps.front().gravity};
  ReturnFreedMemory();
  std::vector<ReportPicture> pictures;
  for (const auto& [view, name] : kViews) {  // one at a time, for less memory
    const cv::Mat drawn = DrawCloud(scene, view);
    if (pictures.empty()) folder.Write("semidense.png", EncodePng(drawn));
    pictures.push_back({name, "image/jpeg", EncodeJpeg(drawn, kJpegQuality)});
  }
  return {std::move(scene), std::move(pictures)};
}

ShapeViews LandmarkViews(const RunResults& results, Cloud landmarks) {
  ShapeViews views{{std::move(landmarks), PathOf(results), results.maps.front().gravity}, {}};
  const cv::Mat drawn = DrawCloud(views.scene, kViews[0].first);
  views.pictures = {{std::string("landmarks ") + kViews[0].second, "image/jpeg",
                     EncodeJpeg(drawn, kJpegQuality)}};
  return views;
}

}  // namespace alidade
