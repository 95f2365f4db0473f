#include "alidade/io/ros/messages/picture_of_message.h"

#include <algorithm>

#include "alidade/base/error.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/ros/messages/compressed_depth.h"
#include "alidade/io/ros/messages/raw_encoding.h"

namespace alidade {

DecodedImage PictureOf(const RosPicture& picture, ImageUse use) {
  if (!picture.compressed) return DecodeRawPicture(picture, use);
  if (IsCompressedDepth(picture) && use != ImageUse::kDepth)
    ThrowInput("is a depth image, not a camera image");
  DecodedImage decoded = IsCompressedDepth(picture) ? DecodeCompressedDepth(picture)
                                                    : DecodeImageBytes(picture.data, use);
  if (!decoded.problem.empty()) ThrowInput(decoded.problem);
  const int type = decoded.image.type();
  if (use == ImageUse::kDepth && type != CV_16UC1 && type != CV_32FC1)
    ThrowInput("is not a depth image: it has 8 bits");
  return decoded;
}

void CheckEncoding(const RosPicture& picture) {
  if (!picture.compressed) CheckRawEncoding(picture.encoding);
}

cv::Size SizeOfPicture(const RosPicture& picture) {
  if (!picture.compressed)
    return {static_cast<int>(std::min<uint32_t>(picture.width, kMostSide + 1)),
            static_cast<int>(std::min<uint32_t>(picture.height, kMostSide + 1))};
  if (IsCompressedDepth(picture)) return SizeOfCompressedDepth(picture);
  if (LooksLikeJpeg(picture.data)) return JpegSize(picture.data);
  if (LooksLikePng(picture.data)) return PngSize(picture.data);
  const DecodedImage decoded = DecodeImageBytes(picture.data, ImageUse::kGray);
  return decoded.problem.empty() ? decoded.image.size() : cv::Size();
}

bool IsDepth(const RosPicture& picture) {
  if (IsCompressedDepth(picture)) return true;
  const std::string start = picture.encoding.substr(0, 5);
  return start == "16UC1" || start == "32FC1";
}

}  // namespace alidade
