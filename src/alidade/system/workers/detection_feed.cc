#include "alidade/system/workers/detection_feed.h"

#include <chrono>
#include <string>

#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/base/timing.h"
#include "alidade/detect/suppress.h"
#include "alidade/system/health.h"

namespace alidade {

DetectionFeed::DetectionFeed(std::shared_ptr<Detector> detector, const DynamicsSettings& settings,
                             bool threaded, uint64_t seed)
    : detector_(std::move(detector)),
      settings_(settings),
      late_(detector_ && detector_->AnswersLate()),
      threaded_(threaded && !late_),
      random_(seed) {
  if (detector_ && threaded_) thread_ = std::thread([this] { Run(); });
}

DetectionFeed::~DetectionFeed() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void DetectionFeed::Fail(int number) noexcept {
  failed_ = true;
  const std::exception_ptr failure = std::current_exception();
  {
    std::lock_guard<std::mutex> lock(mutex_);
    failure_ = failure;
    offered_.release();
  }
  try {
    LogWarning("the detector failed at frame " + std::to_string(number) + " (" + WhatOf(failure) +
               "); moving objects are found by geometry alone from now on");
  } catch (...) {  // no memory for the warning: failure() still reports it
  }
}

std::exception_ptr DetectionFeed::failure() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return failure_;
}

std::optional<FrameDetections> DetectionFeed::Detect(int number, const cv::Mat& image) {
  const Stopwatch watch;
  try {
    FrameDetections answer{number, detector_->Detect(image)};
    KeepBest(answer.detections, told_);
    milliseconds_.Add(watch.Milliseconds());
    std::lock_guard<std::mutex> lock(mutex_);
    if (random_.Uniform() < settings_.drop_detections) return {};
    return answer;
  } catch (...) {
    Fail(number);
    return {};
  }
}

void DetectionFeed::Offer(int number, const cv::Mat& image) {
  if (!detector_ || late_ || failed_) return;
  if (threaded_) {
    cv::Mat copy = image.clone();
    {
      std::lock_guard<std::mutex> lock(mutex_);
      std::swap(offered_, copy);
      offered_number_ = number;
    }
    changed_.notify_all();
  } else if (offers_++ % settings_.detector_every_frames == 0) {
    if (auto answer = Detect(number, image)) answers_.push_back(std::move(*answer));
  }
}

std::optional<FrameDetections> DetectionFeed::Take(int number) {
  if (late_) {
    std::optional<FrameDetections> answer = detector_->TakeAnswer();
    if (!answer || answer->number > number) return {};
    KeepBest(answer->detections, told_);
    return answer;
  }
  std::lock_guard<std::mutex> lock(mutex_);
  std::optional<FrameDetections> newest;
  const int due = threaded_ ? number : number - settings_.detector_latency_frames;
  while (!answers_.empty() && answers_.front().number <= due) {
    newest = std::move(answers_.front());
    answers_.pop_front();
  }
  return newest;
}

void DetectionFeed::Run() {
  KeepLoopsOnThisThread();
  LowerThreadPriority();
  while (!failed_) {
    cv::Mat image;
    int number = 0;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [&] { return stopping_ || !offered_.empty(); });
      if (stopping_) return;
      std::swap(image, offered_);
      offered_.release();
      number = offered_number_;
    }
    const Stopwatch watch;
    auto answer = Detect(number, image);
    std::unique_lock<std::mutex> lock(mutex_);
    try {
      if (answer) answers_.push_back(std::move(*answer));
    } catch (...) {
      lock.unlock();
      return Fail(number);
    }
    const std::chrono::duration<double, std::milli> rest(watch.Milliseconds() *
                                                         settings_.detector_rest);
    if (changed_.wait_for(lock, rest, [&] { return stopping_; })) return;
  }
}

}  // namespace alidade
