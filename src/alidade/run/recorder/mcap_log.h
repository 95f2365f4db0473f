// An MCAP file on the disk, for what RosLog tells. Its chunks are compressed with zstd where the
// library was there when this was built.
#pragma once

#include <string>

#include "alidade/ros/ros_log.h"
#include "alidade/run/folder/draft_file.h"

namespace alidade {

class McapLog {
 public:
  // Throws Error (input) when it cannot be made. `program`: "alidade 0.1.0".
  McapLog(const std::string& path, const std::string& program);

  RosLog& log() { return log_; }
  void Close();  // throws Error (input) when not all of it could be written
  bool good() const { return good_; }
  size_t bytes() const { return file_.bytes(); }

 private:
  DraftFile file_;
  bool good_ = true;  // all so far is written
  RosLog log_;
};

}  // namespace alidade
