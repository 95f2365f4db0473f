#include "fuzz/use_decoded.h"

#include <string>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {
namespace {

bool IsType(const cv::Mat& image, ImageUse use) {
  switch (use) {
    case ImageUse::kColor:
      return image.type() == CV_8UC3;
    case ImageUse::kDepth:
      return image.type() == CV_16UC1;
    default:
      return image.type() == CV_8UC1 || image.type() == CV_16UC1;
  }
}

}  // namespace

void UseDecoded(std::string_view bytes, Decode* decode, cv::Size claimed) {
  std::string problem;
  bool any = false;
  for (const ImageUse use :
       {ImageUse::kGray, ImageUse::kColor, ImageUse::kDepth, ImageUse::kGrayAndColor}) {
    const DecodedImage decoded = decode(bytes, use);
    Expect(decoded.image.empty() != decoded.problem.empty(), "neither a picture nor a problem");
    if (decoded.image.empty()) {
      problem = decoded.problem;
      continue;
    }
    any = true;
    Expect(IsType(decoded.image, use), "a picture of another type than was asked for");
    Expect(decoded.image.size() == claimed, "a picture of another size than its header says");
    Expect(IsPictureSize(claimed.width, claimed.height), "a picture that is too large");
    Expect(decoded.color.empty() ||
               (use == ImageUse::kGrayAndColor && decoded.color.type() == CV_8UC3 &&
                decoded.color.size() == claimed),
           "colours of another kind than the picture");
  }
  if (!any) ThrowInput(problem);
}

}  // namespace alidade::fuzz
