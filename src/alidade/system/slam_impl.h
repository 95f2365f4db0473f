// What is behind Slam: the pipeline of frames, the clock, and who may drive them. Private to
// system/.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "alidade/system/camera/camera_clock.h"
#include "alidade/system/frame_pipeline.h"
#include "alidade/system/slam.h"

namespace alidade {

class Slam::Impl {
 public:
  Impl(const Camera& given, const SlamSettings& settings,
       const std::shared_ptr<Detector>& detector);
  TrackResult Track(const FrameInput& input);
  void Load(const SavedMap& saved);
  void LeaveOut(const cv::Mat& mask);
  void SetImu(const ImuModel& imu);
  void KeepFramesIn(std::shared_ptr<ByteStore> store);
  void Reset();
  void Forget();
  void SetMapping(bool on);
  void Finish(double limit);

  SlamHealth Health() const;
  Camera CameraNow() const;  // with the rolling-shutter readout estimated so far
  const SlamSettings& settings() const { return settings_; }
  FramePipeline& pipeline() { return pipeline_; }
  const FramePipeline& pipeline() const { return pipeline_; }
  const SampleLog& frame_milliseconds() const { return frame_ms_; }
  int frames() const { return frames_; }
  int cuts() const { return cuts_; }

 private:
  void BeginFrame(double time);
  const char* CheckTime(double time);
  void Cut();

  Camera given_;
  SlamSettings settings_;
  FramePipeline pipeline_;
  CameraClock clock_;
  bool jump_warned_ = false;  // the user was warned of a jump of the time stamps
  bool restarted_ = false;    // Reset() was called since the last frame
  SampleLog frame_ms_;
  std::atomic<int> frames_{0}, cuts_{0};
  std::mutex driving_;  // held by the driving call that is running
};

}  // namespace alidade
