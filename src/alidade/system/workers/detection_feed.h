// Runs the detector beside the tracker. Threaded, the tracker does not wait for its results.
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

// Threaded: a separate thread runs the detector on the newest frame whenever it is free. Inline:
// the detector runs on the first frame and on every detector_every_frames-th one after it, and each
// result is returned detector_latency_frames frames later, so that runs are reproducible. A
// detector that runs elsewhere (Detector::AnswersLate()) gets no frames here; its results arrive
// from outside.
class DetectionFeed {
 public:
  // `detector` may be null: then there are no results.
  DetectionFeed(std::shared_ptr<Detector> detector, const DynamicsSettings& settings, bool threaded,
                uint64_t seed);
  ~DetectionFeed();

  // `image`: CV_8UC3 or CV_8UC1; copied when threaded. `number`: Frame::number, increasing.
  void Offer(int number, const cv::Mat& image);
  // The newest result that is due at frame `number`, if any. Each is returned once at most.
  std::optional<FrameDetections> Take(int number);
  // Any thread may call these.
  const SampleLog& milliseconds() const { return milliseconds_; }  // one per frame it processed
  std::exception_ptr failure() const;  // exception that ended the detector; null: it runs

 private:
  void Run();
  std::optional<FrameDetections> Detect(int number, const cv::Mat& image);
  void Fail(int number) noexcept;  // ends the detector; called while its exception is handled

  std::shared_ptr<Detector> detector_;
  DynamicsSettings settings_;
  bool late_;  // Detector::AnswersLate()
  bool threaded_;
  bool told_ = false;  // of too many detections; used by the thread that asks the detector
  Random random_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  cv::Mat offered_;  // threaded: the newest frame that is not taken yet; empty: none
  int offered_number_ = 0;
  int offers_ = 0;  // inline: frames offered so far
  bool stopping_ = false;
  std::deque<FrameDetections> answers_;
  SampleLog milliseconds_;
  std::atomic<bool> failed_{false};
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace alidade
