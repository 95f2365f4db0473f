#include "alidade/run/recorder/stream_feed.h"

#include <algorithm>
#include <chrono>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/run/sources/truth.h"
#include "alidade/system/health.h"

namespace alidade {
namespace {

std::vector<StreamTruth> TruthOf(const Trajectory& trajectory) {
  std::vector<StreamTruth> truth;
  for (const StampedPose& pose : trajectory) truth.push_back({pose.time, pose.T_world_camera});
  return truth;
}

StreamSource SourceOf(const std::string& program, const Slam& slam, const RunSetup& setup) {
  StreamSource source;
  source.program = program;
  source.source = setup.source_path;
  source.sensor = NameOf(setup.settings.slam.sensor);
  source.unit = setup.settings.slam.sensor == Sensor::kMono ? "map units" : "m";
  source.frames = setup.source.frames;
  source.live = setup.source.live;
  source.camera = slam.camera();
  source.R_camera_rectified = setup.source.R_camera_rectified;
  source.truth = TruthOf(TruthBeside(setup.source_path));
  return source;
}

}  // namespace

StreamFeed::StreamFeed(std::string program, std::optional<std::string> file,
                       const StreamFeedSettings& settings)
    : program_(std::move(program)), file_path_(std::move(file)), settings_(settings) {
  settings.Check();
}

StreamFeed::~StreamFeed() {
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void StreamFeed::Begin(const WatchedRun& run, const std::string& folder) {
  log_ = &run.log;
  playback_.may_pause = !run.setup.source.live;
  Start(run.slam, SourceOf(program_, run.slam, run.setup), folder);
}

void StreamFeed::BeginLive(const Slam& slam, StreamSource source) {
  copies_images_ = true;
  source.program = program_;
  Start(slam, std::move(source), "");
}

void StreamFeed::Start(const Slam& slam, StreamSource source, const std::string& folder) {
  slam_ = &slam;
  {
    const std::lock_guard<std::mutex> lock(encoder_mutex_);
    encoder_ = std::make_unique<StreamEncoder>(std::move(source), settings_.stream);
    if (file_path_) {
      file_ = MakeRecordFile(file_path_->empty() ? folder + "/run.stream" : *file_path_, program_,
                             settings_);
    }
    Tell({encoder_->Hello(), encoder_->Playback(playback_)});
  }
  thread_ = std::thread([this] { Run(); });
}

// Viewers may pause a recording.
void StreamFeed::Wait(bool (*interrupted)()) {
  std::unique_lock<std::mutex> lock(queue_mutex_);
  while (paused_ && steps_ == 0 && !interrupted())
    changed_.wait_for(lock, std::chrono::milliseconds(50));
  if (paused_ && steps_ > 0) --steps_;
}

void StreamFeed::Frame(const SourceFrame& frame, const TrackResult& result) {
  try {
    Show(frame, result);
  } catch (...) {
    Fail();
  }
}

void StreamFeed::Show(const SourceFrame& frame, const TrackResult& result) {
  Shown shown;
  shown.frame = FrameAsLeft(*slam_, frame.number, frame.time, result, latest_);
  // The time may be set back between two recordings.
  const double since = frame.time - picture_time_;
  if (settings_.pictures_hz > 0 && !(since >= 0 && since < 1 / settings_.pictures_hz)) {
    picture_time_ = frame.time;
    shown.image = frame.color.empty() ? frame.image : frame.color;
    if (copies_images_) shown.image = shown.image.clone();
  }
  {
    std::unique_lock<std::mutex> lock(queue_mutex_);
    const auto most = static_cast<size_t>(settings_.max_waiting);
    if (file_path_) {
      changed_.wait(lock, [&] { return failed_ || queue_.size() < most; });
    } else if (queue_.size() >= most) {
      queue_.pop_front();
    }
    if (failed_) return;
    queue_.push_back(std::move(shown));
  }
  changed_.notify_all();
}

void StreamFeed::Run() {
  while (true) {
    Shown shown;
    {
      std::unique_lock<std::mutex> lock(queue_mutex_);
      working_ = false;
      changed_.notify_all();
      changed_.wait(lock, [&] { return stop_ || failed_ || !queue_.empty(); });
      if (stop_ || failed_) return;
      shown = std::move(queue_.front());
      queue_.pop_front();
      working_ = true;
    }
    changed_.notify_all();
    try {
      Encode(shown);
    } catch (...) {
      Fail();
    }
  }
}

void StreamFeed::Fail() noexcept {
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (std::exchange(failed_, true)) return;
    queue_.clear();
    working_ = paused_ = false;
  }
  changed_.notify_all();
  try {
    LogWarning("recording the stream stopped (" + WhatOf(std::current_exception()) +
               "); the run continues without it");
  } catch (...) {  // memory is exhausted
  }
}

void StreamFeed::Encode(Shown& shown) {
  if (!shown.image.empty()) {
    cv::Mat image = shown.image;
    if (image.cols > settings_.picture_width) {
      const int height = std::max(1, image.rows * settings_.picture_width / image.cols);
      cv::resize(shown.image, image, {settings_.picture_width, height}, 0, 0, cv::INTER_AREA);
    }
    shown.frame.picture = {image.cols, image.rows, "image/jpeg",
                           EncodeJpeg(image, settings_.picture_quality)};
  }
  const std::lock_guard<std::mutex> lock(encoder_mutex_);
  if (std::exchange(playback_.finished, false)) Tell({encoder_->Playback(playback_)});
  Tell(encoder_->Add(shown.frame));
  ++frames_;
  const double since = shown.frame.time - whole_time_;
  if (file_ && file_->takes_whole() && (since < 0 || since >= settings_.whole_seconds)) {
    if (whole_time_ > -1e300) {
      for (const std::string& message : encoder_->Whole()) file_->Write(message);
    }
    whole_time_ = shown.frame.time;
  }
}

void StreamFeed::Tell(std::vector<std::string> messages) {
  for (std::string& bytes : messages) {
    const auto message = std::make_shared<const std::string>(std::move(bytes));
    if (file_) {
      file_->Write(*message);
    } else {
      bytes_ += message->size();
    }
    for (const auto& [id, take] : takers_) take(message);
  }
  if (file_) bytes_ = file_->bytes();
}

void StreamFeed::Drain() {
  std::unique_lock<std::mutex> lock(queue_mutex_);
  changed_.wait(lock, [&] { return queue_.empty() && !working_; });
}

void StreamFeed::Finished() {
  Drain();
  try {
    TellEnd();
  } catch (...) {
    Fail();
  }
}

void StreamFeed::TellEnd() {
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (failed_) return;
  }
  const std::lock_guard<std::mutex> lock(encoder_mutex_);
  Tell(encoder_->End(slam_->Snapshot(), slam_->camera()));
  if (log_ != nullptr &&
      !log_->truth.empty()) {  // of a rendered source, which tells it frame by frame
    encoder_->SetTruth(TruthOf(log_->truth));
    Tell({encoder_->Hello()});
  }
  playback_.finished = true;
  playback_.paused = playback_.may_pause = false;
  Tell({encoder_->Playback(playback_)});
}

void StreamFeed::Written(const std::string& folder) {
  const std::lock_guard<std::mutex> lock(encoder_mutex_);
  if (!file_) return;
  try {
    file_->Close(folder);
    bytes_ = file_->bytes();
  } catch (const Error&) {  // the disk is full
    file_ = nullptr;
    throw;
  } catch (...) {
    Fail();
  }
  file_ = nullptr;
}

int StreamFeed::Join(Take take) {
  const std::lock_guard<std::mutex> lock(encoder_mutex_);
  if (encoder_) {
    for (std::string& bytes : encoder_->Whole())
      take(std::make_shared<const std::string>(std::move(bytes)));
    take(std::make_shared<const std::string>(encoder_->Playback(playback_)));
  }
  takers_[next_taker_] = std::move(take);
  return next_taker_++;
}

void StreamFeed::Leave(int id) {
  const std::lock_guard<std::mutex> lock(encoder_mutex_);
  takers_.erase(id);
}

void StreamFeed::Control(StreamControl control) {
  const std::lock_guard<std::mutex> encoder(encoder_mutex_);
  if (!playback_.may_pause) return;
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (control == StreamControl::kStep) {
      if (paused_) ++steps_;
      paused_ = true;
    } else {
      paused_ = control == StreamControl::kPause;
      steps_ = 0;
    }
    playback_.paused = paused_;
  }
  changed_.notify_all();
  Tell({encoder_->Playback(playback_)});
}

}  // namespace alidade
