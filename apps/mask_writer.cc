#include "mask_writer.h"

#include <opencv2/imgproc.hpp>

#include "alidade/io/files/image_codec.h"
#include "alidade/io/trajectory.h"

namespace alidade {

void MaskWriter::Write(const SourceFrame& frame, const cv::Mat& mask) {
  cv::Mat picture = cv::Mat::zeros(frame.image.size(), CV_8U);
  if (!mask.empty()) cv::resize(mask, picture, frame.image.size(), 0, 0, cv::INTER_NEAREST);
  const std::string stamp = frame.stamp.empty() ? FormatTime(frame.time) : frame.stamp;
  const std::string name = MaskPictureFile(stamp);
  folder_.Write(name, EncodePng(picture), Sync::kNo);
  written_.push_back(name);
  list_ += stamp;
  list_ += " ";
  list_ += name;
  list_ += "\n";
}

void MaskWriter::Finish() { folder_.Write("mask.txt", std::string(kMaskListHeader) + list_); }

void MaskWriter::Discard() {
  for (const std::string& name : written_) folder_.Discard(name);
}

}  // namespace alidade
