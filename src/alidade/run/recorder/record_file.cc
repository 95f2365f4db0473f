#include "alidade/run/recorder/record_file.h"

#include "alidade/run/folder/draft_file.h"
#include "alidade/run/folder/final_state.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/recorder/mcap_log.h"
#include "alidade/run/recorder/stream_file.h"
#include "alidade/run/recorder/stream_to_ros.h"

namespace alidade {
namespace {

class StreamRecord : public RecordFile {
 public:
  explicit StreamRecord(const std::string& path) : file_(path) {}
  bool Write(std::string_view message) override { return file_.Write(message); }
  void Close(const std::string&) override { file_.Close(); }
  size_t bytes() const override { return file_.bytes(); }
  bool takes_whole() const override { return true; }

 private:
  StreamFileWriter file_;
};

class McapRecord : public RecordFile {
 public:
  McapRecord(const std::string& path, const std::string& program,
             const StreamFeedSettings& settings)
      : file_(path, program), ros_(file_.log(), settings) {}
  bool Write(std::string_view message) override {
    ros_.Take(message);
    return file_.good();
  }
  void Close(const std::string& results) override {
    ros_.End(results.empty() ? FinalState{} : FinalStateIn(results));
    file_.Close();
  }
  size_t bytes() const override { return file_.bytes(); }
  bool takes_whole() const override { return false; }

 private:
  McapLog file_;
  StreamToRos ros_;
};

}  // namespace

bool IsMcap(const std::string& path) {
  constexpr std::string_view kEnding = ".mcap";
  return path.size() > kEnding.size() &&
         path.compare(path.size() - kEnding.size(), kEnding.size(), kEnding) == 0;
}

std::unique_ptr<RecordFile> MakeRecordFile(const std::string& path, const std::string& program,
                                           const StreamFeedSettings& settings) {
  CheckIsNoResult(path);
  if (IsMcap(path)) return std::make_unique<McapRecord>(path, program, settings);
  return std::make_unique<StreamRecord>(path);
}

}  // namespace alidade
