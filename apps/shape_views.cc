#include "shape_views.h"

#include <opencv2/core.hpp>
#include <string>
#include <utility>

#include "alidade/base/parallel.h"
#include "alidade/io/files/image_codec.h"

namespace alidade {
namespace {

constexpr int kJpegQuality = 88;  // a third of the bytes of a PNG, and the dots stay dots

constexpr std::pair<CloudView, const char*> kViews[] = {
    {CloudView::kBehind, "from behind the first camera"},
    {CloudView::kFront, "as the first camera looked"},
    {CloudView::kSide, "from its right"},
    {CloudView::kAbove, "from above"}};

}  // namespace

std::vector<ReportPicture> WriteShapeViews(OutputFolder& folder, const CloudScene& scene) {
  constexpr int kCount = static_cast<int>(std::size(kViews));
  std::vector<cv::Mat> drawn(kCount);
  ParallelFor(kCount,
              [&](int i) { drawn[static_cast<size_t>(i)] = DrawCloud(scene, kViews[i].first); });
  folder.Write("semidense.png", EncodePng(drawn[0]));
  std::vector<ReportPicture> pictures;
  for (size_t i = 0; i < drawn.size(); ++i)
    pictures.push_back({kViews[i].second, "image/jpeg", EncodeJpeg(drawn[i], kJpegQuality)});
  return pictures;
}

}  // namespace alidade
