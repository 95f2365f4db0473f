// The file of --record and --record-to: the stream (run.stream), or its conversion to MCAP.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "alidade/run/setup/stream_settings.h"

namespace alidade {

class RecordFile {
 public:
  virtual ~RecordFile() = default;  // without Close(): the file is removed
  // Adds a message of the stream. Returns false if writing failed (disk full); nothing more is
  // written then. Throws Error for an invalid message.
  virtual bool Write(std::string_view message) = 0;
  // `results`: the result folder of the run; empty: there is none. Throws Error (input) if writing
  // was incomplete.
  virtual void Close(const std::string& results) = 0;
  virtual size_t bytes() const = 0;  // so far
  // Whether it needs complete states in addition to changes.
  virtual bool takes_whole() const = 0;
};

bool IsMcap(const std::string& path);  // by the ending of the name

// Throws Error (input) if the file cannot be created. `program`: "alidade 0.2.0".
std::unique_ptr<RecordFile> MakeRecordFile(const std::string& path, const std::string& program,
                                           const StreamFeedSettings& settings);

}  // namespace alidade
