// What --record and --record-to write: the stream as it is (run.stream), or made into an MCAP file.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "alidade/run/setup/stream_settings.h"

namespace alidade {

class RecordFile {
 public:
  virtual ~RecordFile() = default;  // without Close(): nothing stays
  // A message of the stream. False when the disk is full or gone; nothing more is written then.
  // Throws Error on what is no message.
  virtual bool Write(std::string_view message) = 0;
  // `results`: the folder of what the run left. Throws Error (input) when not all of the file could
  // be written.
  virtual void Close(const std::string& results) = 0;
  virtual size_t bytes() const = 0;  // so far
  // Whole states are of use to it, besides what has changed.
  virtual bool takes_whole() const = 0;
};

bool IsMcap(const std::string& path);  // by its ending

// Throws Error (input) when it cannot be made. `program`: "alidade 0.1.0".
std::unique_ptr<RecordFile> MakeRecordFile(const std::string& path, const std::string& program,
                                           const StreamFeedSettings& settings);

}  // namespace alidade
