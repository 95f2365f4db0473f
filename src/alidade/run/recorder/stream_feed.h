// Encodes a run as a stream. A thread of its own encodes each frame, adds the camera image and
// passes the messages to connected viewers and to a file. If that fails (out of memory), a warning
// is logged and the stream ends; the run continues.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "alidade/run/play/watcher.h"
#include "alidade/run/recorder/record_file.h"
#include "alidade/run/setup/stream_settings.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/stream/stream_hub.h"

namespace alidade {

class StreamFeed : public RunWatcher, public StreamHub {
 public:
  // `file`: where the stream is stored, as MCAP if it ends in .mcap; nullopt: not stored; empty:
  // run.stream in the result folder.
  StreamFeed(std::string program, std::optional<std::string> file,
             const StreamFeedSettings& settings = {});
  ~StreamFeed() override;

  // For a Slam that its user feeds, instead of Begin(run): `slam` must outlive the calls. Images of
  // frames are copied, for the user may use their memory again. Frame(), Finished() and Written("")
  // as for a run; more frames may follow Finished(), but not Written().
  void BeginLive(const Slam& slam, StreamSource source);

  // The run's.
  void Begin(const WatchedRun& run, const std::string& folder) override;
  void Wait(bool (*interrupted)()) override;
  void Frame(const SourceFrame& frame, const TrackResult& result) override;
  void Finished() override;
  void Written(const std::string& folder) override;

  // Calls of the servers.
  int Join(Take take) override;
  void Leave(int id) override;
  void Control(StreamControl control) override;

  // Size of the file, or of all messages if there is no file.
  size_t bytes() const { return bytes_; }
  int frames() const { return frames_; }

 private:
  void Fail() noexcept;  // handles the current exception
  void Start(const Slam& slam, StreamSource source, const std::string& folder);
  struct Shown {
    StreamFrame frame;
    cv::Mat image;  // image to encode; empty: none
  };
  void Show(const SourceFrame& frame, const TrackResult& result);
  void TellEnd();
  void Run();
  void Encode(Shown& shown);
  void Tell(std::vector<std::string> messages);  // requires encoder_mutex_
  void Drain();

  const std::string program_;
  const std::optional<std::string> file_path_;
  const StreamFeedSettings settings_;
  const Slam* slam_ = nullptr;
  const RunLog* log_ = nullptr;
  bool copies_images_ = false;
  LatestTimes latest_;                                  // of the previous frame
  double picture_time_ = -1e300, whole_time_ = -1e300;  // seconds of the recording

  std::mutex encoder_mutex_;  // guards all fields up to the next mutex
  std::unique_ptr<StreamEncoder> encoder_;
  std::unique_ptr<RecordFile> file_;
  std::map<int, Take> takers_;
  int next_taker_ = 0;
  StreamPlayback playback_;

  mutable std::mutex queue_mutex_;
  std::condition_variable changed_;
  std::deque<Shown> queue_;
  bool working_ = false, stop_ = false, failed_ = false;
  bool paused_ = false;
  int steps_ = 0;  // frames to process while paused

  std::atomic<size_t> bytes_{0};
  std::atomic<int> frames_{0};
  std::thread thread_;
};

}  // namespace alidade
