// mask/TIMESTAMP.png and mask.txt: the moving objects left out of each frame
// (docs/guides/moving-objects.md).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/run/folder/draft_folder.h"
#include "alidade/run/folder/output_folder.h"

namespace alidade {

// Images are gathered in a temporary folder until Finish(). Without Finish() (the run failed or was
// killed) they are removed.
class MaskWriter {
 public:
  explicit MaskWriter(OutputFolder& folder) : folder_(folder) {}

  // `mask`: CV_8U, 255 = left out; scaled to the size of the frame by nearest neighbor; empty:
  // nothing was left out. Throws Error (input) if writing fails; then no masks are written at all.
  void Write(const SourceFrame& frame, const cv::Mat& mask);
  // Moves the images to their place and writes their list. Throws Error (input), leaving neither.
  void Finish();
  void Discard();  // removes everything that was not finished

 private:
  void Publish();

  OutputFolder& folder_;
  std::unique_ptr<DraftFolder> draft_;
  std::vector<std::string> written_;  // names in the output folder
  std::string list_;
  bool given_up_ = false;
};

}  // namespace alidade
