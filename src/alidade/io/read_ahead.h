// Reads frames in a thread of its own, so that decoding images never counts as SLAM time.
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
  // At most `capacity` frames wait to be taken.
  explicit ReadAhead(std::unique_ptr<FrameSource> source, int capacity = 8);
  ~ReadAhead() override;

  const SourceInfo& Info() const override { return info_; }
  // Waits for the next frame. Rethrows, once, what the source threw; after that there are no more.
  std::optional<SourceFrame> Next() override;
  bool ready() const;  // whether Next() would have a frame at once
  // CPU time of the reading thread so far, seconds: to be taken from the process's.
  double ReadCpuSeconds() const { return cpu_seconds_.load(); }

 private:
  void Run();

  std::unique_ptr<FrameSource> source_;  // the thread's alone, once it runs
  SourceInfo info_;
  const size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<SourceFrame> queue_;  // guarded by mutex_, as are the next three
  std::exception_ptr failure_;
  bool finished_ = false, stop_ = false;
  std::atomic<double> cpu_seconds_{0};
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace alidade
