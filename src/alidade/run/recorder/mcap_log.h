// Writes the messages of RosLog to an MCAP file. Chunks are compressed with zstd if the library was
// available when this was built.
#pragma once

#include <string>

#include "alidade/ros/mcap_sink.h"
#include "alidade/ros/ros_log.h"
#include "alidade/run/folder/draft_file.h"

namespace alidade {

class McapLog {
 public:
  // Throws Error (input) if the file cannot be created. `program`: "alidade 0.2.0".
  McapLog(const std::string& path, const std::string& program);

  RosLog& log() { return log_; }
  void Close();  // throws Error (input) if writing was incomplete
  bool good() const { return good_; }
  size_t bytes() const { return file_.bytes(); }

 private:
  DraftFile file_;
  bool good_ = true;  // all writes so far succeeded
  McapSink sink_;
  RosLog log_;
};

}  // namespace alidade
