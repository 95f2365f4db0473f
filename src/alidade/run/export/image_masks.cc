#include "alidade/run/export/image_masks.h"

#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_file.h"
#include "alidade/io/text.h"
#include "alidade/io/trajectory.h"

namespace alidade {

ImageMasks::ImageMasks(const std::string& folder) : folder_(folder) {
  const std::string list = folder + "/mask.txt";
  if (folder.empty() || !IsFile(list)) {
    ThrowUsage(
        "--masks needs masks that the run wrote, and there is no mask.txt: run again with "
        "--dynamics geometry --write-masks");
  }
  const std::string text = ReadFile(list);
  for (const TextLine& line : ContentLines(text)) {
    const auto fields = Fields(line.text);
    if (fields.size() >= 2) files_.emplace(fields[0], fields[1]);
  }
}

cv::Mat ImageMasks::Of(const SourceFrame& frame, cv::Size size) const {
  const auto file = files_.find(frame.stamp.empty() ? FormatTime(frame.time) : frame.stamp);
  if (file == files_.end()) return {size, CV_8U, cv::Scalar(255)};
  cv::Mat moving = ReadImageGray(folder_ + "/" + file->second);
  if (moving.size() != size) cv::resize(moving, moving, size, 0, 0, cv::INTER_NEAREST);
  return moving < 128;
}

}  // namespace alidade
