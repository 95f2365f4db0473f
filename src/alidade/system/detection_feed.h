// The detector beside the tracker: given frames, it answers when it can; nobody waits for it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/base/timing.h"
#include "alidade/detect/detector.h"
#include "alidade/dynamics/settings.h"

namespace alidade {

// Threaded: a thread of its own that takes the newest frame whenever it is free. Inline: the
// first frame and every k-th after it, each answer handed over a fixed number of frames later: the
// same every time. One that answers late is given nothing: its answers come from elsewhere.
class DetectionFeed {
 public:
  // `detector` may be null: then there are never answers.
  DetectionFeed(std::shared_ptr<Detector> detector, const DynamicsSettings& settings, bool threaded,
                uint64_t seed);
  ~DetectionFeed();

  // `image`: CV_8UC3 or CV_8UC1; copied when it is kept. `number`: Frame::number, growing.
  void Offer(int number, const cv::Mat& image);
  // The answer that is due at frame `number`, if any: the newest.
  std::optional<FrameDetections> Take(int number);
  // Any thread may ask.
  const SampleLog& milliseconds() const { return milliseconds_; }  // one per frame it was given
  std::exception_ptr failure() const;  // what ended the detector; null: nothing did

 private:
  void Run();
  std::optional<FrameDetections> Detect(int number, const cv::Mat& image);
  void Fail(int number) noexcept;  // by what is being handled

  std::shared_ptr<Detector> detector_;
  DynamicsSettings settings_;
  bool late_;  // it works elsewhere
  bool threaded_;
  Random random_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  cv::Mat offered_;  // threaded: the newest frame; empty when taken
  int offered_number_ = 0;
  int offers_ = 0;  // inline: so far
  bool stopping_ = false;
  std::deque<FrameDetections> answers_;
  SampleLog milliseconds_;
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace alidade
