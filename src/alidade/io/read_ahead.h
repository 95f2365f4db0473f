// Reads frames in a separate thread, so that image decoding does not count as SLAM time.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>

#include "alidade/io/frame_source.h"

namespace alidade {

class ReadAhead : public FrameSource {
 public:
  // Buffers at most `capacity` frames: about 1 MB each with depth at 640 x 480, 2 MB with color. Of
  // a live source it keeps the newest frame only, with the inertial readings of those it replaced.
  explicit ReadAhead(std::unique_ptr<FrameSource> source, int capacity = 4);
  ~ReadAhead() override;

  const SourceInfo& Info() const override { return info_; }
  // Blocks until the next frame is available. Rethrows an exception of the source once; afterwards
  // returns nullopt.
  std::optional<SourceFrame> Next() override;
  bool ready() const;  // true when there is a frame
  // Blocks until Next() would not, for at most `seconds`; returns whether it would not.
  bool Wait(double seconds) const;
  int replaced() const;  // frames of a live source that gave way to newer ones so far
  // CPU time of the reading thread so far, seconds. Subtract it from the process's CPU time to get
  // that of SLAM.
  double ReadCpuSeconds() const { return cpu_seconds_.load(); }

 private:
  void Run();

  std::unique_ptr<FrameSource> source_;  // used by the thread only once it runs
  SourceInfo info_;
  const size_t capacity_;
  void Push(SourceFrame frame);  // requires mutex_

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::deque<SourceFrame> queue_;  // guarded by mutex_, like the next four members
  std::exception_ptr failure_;
  bool finished_ = false, stop_ = false;
  int replaced_ = 0;
  std::atomic<double> cpu_seconds_{0};
  std::thread thread_;  // last member: the thread uses all of the above
};

}  // namespace alidade
