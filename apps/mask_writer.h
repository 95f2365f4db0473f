// mask/TIMESTAMP.png and mask.txt: what was left out of each frame as moving.
#pragma once

#include <string>
#include <vector>

#include "alidade/io/frame_source.h"
#include "output_folder.h"

namespace alidade {

class MaskWriter {
 public:
  explicit MaskWriter(OutputFolder& folder) : folder_(folder) {}
  // `mask`: CV_8U, 255 = left out; scaled to the frame's size; empty: nothing was left out.
  void Write(const SourceFrame& frame, const cv::Mat& mask);
  void Finish();   // the list of all that was written
  void Discard();  // takes all of it back

 private:
  OutputFolder& folder_;
  std::vector<std::string> written_;
  std::string list_;
};

}  // namespace alidade
