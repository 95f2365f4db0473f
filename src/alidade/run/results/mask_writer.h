// mask/TIMESTAMP.png and mask.txt: what each frame left out (docs/guides/moving-objects.md).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/io/frame_source.h"
#include "alidade/run/folder/draft_folder.h"
#include "alidade/run/folder/output_folder.h"

namespace alidade {

// Pictures are gathered in a folder beside their place: until Finish() there is no mask/, and when
// it is never called (the run failed, or was killed) none of them stays.
class MaskWriter {
 public:
  explicit MaskWriter(OutputFolder& folder) : folder_(folder) {}

  // `mask`: CV_8U, 255 = left out; scaled to the frame's size, pixel by pixel; empty: nothing was
  // left out. Throws Error (input) when it cannot be written: then there will be no masks at all.
  void Write(const SourceFrame& frame, const cv::Mat& mask);
  // The pictures to their place, then the list of them. Throws Error (input), leaving neither.
  void Finish();
  void Discard();  // takes back all that was not finished

 private:
  void Publish();

  OutputFolder& folder_;
  std::unique_ptr<DraftFolder> draft_;
  std::vector<std::string> written_;  // names in the output folder
  std::string list_;
  bool given_up_ = false;
};

}  // namespace alidade
