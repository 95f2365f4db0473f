#include "alidade/run/results/mask_writer.h"

#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/trajectory.h"

namespace alidade {

namespace fs = std::filesystem;

void MaskWriter::Write(const SourceFrame& frame, const cv::Mat& mask) {
  if (given_up_) return;
  cv::Mat picture = cv::Mat::zeros(frame.image.size(), CV_8U);
  if (!mask.empty()) cv::resize(mask, picture, frame.image.size(), 0, 0, cv::INTER_NEAREST);
  const std::string stamp = frame.stamp.empty() ? FormatTime(frame.time) : frame.stamp;
  const std::string name = MaskPictureFile(stamp);
  try {
    if (!draft_)
      draft_ =
          std::make_unique<DraftFolder>((fs::path(folder_.draft()) / name).parent_path().string());
    // Images are not flushed individually, which would delay the frames.
    AtomicWriteFile(draft_->path() + "/" + stamp + ".png", EncodePng(picture), Sync::kNo);
  } catch (...) {
    Discard();
    throw;
  }
  written_.push_back(name);
  list_ += stamp;
  list_ += " ";
  list_ += name;
  list_ += "\n";
}

void MaskWriter::Publish() {
  if (!draft_) return;
  const fs::path folder = folder_.draft();
  const auto move = [](const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (error) ThrowInput("cannot write " + to.string() + ": " + error.message());
  };
  const fs::path place = (folder / written_.front()).parent_path();
  std::error_code error;
  if (!fs::exists(fs::symlink_status(place, error))) {
    move(draft_->path(), place);
    return;
  }
  for (const std::string& name : written_)  // images of somebody else are there
    move(fs::path(draft_->path()) / fs::path(name).filename(), folder / name);
}

void MaskWriter::Finish() {
  if (given_up_) return;
  try {
    Publish();
    folder_.Write("mask.txt", std::string(kMaskListHeader) + list_);
  } catch (...) {
    for (const std::string& name : written_) folder_.Discard(name);
    Discard();
    throw;
  }
  draft_.reset();
}

void MaskWriter::Discard() {
  draft_.reset();
  written_.clear();
  list_.clear();
  given_up_ = true;
}

}  // namespace alidade
