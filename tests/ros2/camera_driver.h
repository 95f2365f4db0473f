// A camera's driver as a participant of another vendor.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "alidade/run/sources/any_source.h"
#include "ros2/fast_peer.h"
#include "ros2/messages.h"

namespace alidade {

// Sets the environment of this process to a domain that no other test uses, on loopback.
inline int UseOwnDomain() {
  const int domain = 1 + static_cast<int>(getpid() % 100);  // ports below those of the kernel
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  setenv("ROS_DOMAIN_ID", std::to_string(domain).c_str(), 1);
  return domain;
}

// Publishes the frames of a rendered scene, forward and backward again and again, or around and
// around, 32 per second.
class CameraDriver {
 public:
  static constexpr int kFps = 32;  // its times are exact in binary and in nanoseconds

  CameraDriver(int domain, FastPeer::Quality quality, bool depth,
               const std::string& scene = "room?frames=20")
      : peer_(domain) {
    const auto source = OpenAnySource("synth:" + scene + "&width=320&height=240");
    camera_ = source->Info().camera;
    while (auto frame = source->Next()) {
      frame->depth.convertTo(frame->depth, CV_16U, 1000 / camera_.depth_factor);  // millimeters
      frames_.push_back(std::move(*frame));
    }
    image_ = peer_.Advertise("rt/cam/image_raw", kImageType, quality);
    info_ = peer_.Advertise("rt/cam/camera_info", kInfoType, quality);
    if (depth) depth_ = peer_.Advertise("rt/cam/depth/image_raw", kImageType, quality);
  }
  ~CameraDriver() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  // Inertial readings of a camera that turns ever faster, 192 per second, in one topic, or apart
  // and then with half as many accelerations. Before Play().
  void AddImu(bool apart) {
    rates_ = peer_.Advertise(apart ? "rt/cam/gyro" : "rt/cam/imu", kImuMessageType,
                             FastPeer::Quality::kReliable);
    forces_ = apart ? peer_.Advertise("rt/cam/accel", kImuMessageType, FastPeer::Quality::kReliable)
                    : rates_;
  }
  static Eigen::Vector3d RateAt(double time) { return {0.01 * (time - 1000), 0.1, 0}; }
  static Eigen::Vector3d ForceAt(double time) { return {0.02 * (time - 1000), -9.8, 0.5}; }

  void GoAround() { around_ = true; }  // the first frame follows the last one. Before Play()
  // On a busy machine the images come more slowly, with the same stamps: from the first pose on,
  // the next one waits for the pose of the one before, a second at most. Before Play().
  void WaitForPoses() { patient_ = true; }
  void PoseOf(double time) {
    const std::lock_guard<std::mutex> lock(mutex_);
    placed_ = std::lround((time - 1000) * kFps);
    pose_came_.notify_all();
  }

  void Play(size_t from = 0) {
    thread_ = std::thread([this, from] { Publish(from); });
  }

  FastPeer& peer() { return peer_; }
  const Camera& camera() const { return camera_; }
  static double TimeOf(size_t i) { return 1000 + static_cast<double>(i) / kFps; }
  const SourceFrame& FrameAt(double time) const {
    return Nth(static_cast<size_t>(std::lround((time - 1000) * kFps)));
  }
  // When the image of that time was published.
  std::chrono::steady_clock::time_point SentAt(double time) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto sent = sent_.find(std::lround((time - 1000) * kFps));
    return sent == sent_.end() ? std::chrono::steady_clock::time_point() : sent->second;
  }

 private:
  const SourceFrame& Nth(size_t i) const {
    if (around_) return frames_[i % frames_.size()];
    const size_t last = frames_.size() - 1, at = i % (2 * last);
    return frames_[at <= last ? at : 2 * last - at];
  }

  // Those since the image before, and up to this one.
  void PublishImu(size_t i) {
    if (rates_ < 0) return;
    constexpr int kPerImage = 6;
    for (int k = 1; k <= kPerImage; ++k) {
      const double time = TimeOf(i) + (k - kPerImage) / (1.0 * kPerImage * kFps);
      const Eigen::Vector3d none = Eigen::Vector3d::Zero();
      const bool both = rates_ == forces_;
      peer_.Publish(rates_, EncodeImu(time, "cam_imu", RateAt(time), both ? ForceAt(time) : none));
      if (!both && k % 2 == 0)
        peer_.Publish(forces_, EncodeImu(time, "cam_imu", none, ForceAt(time)));
    }
  }

  void Publish(size_t from) {
    auto due = std::chrono::steady_clock::now();
    for (size_t i = from; !stop_; ++i) {
      std::this_thread::sleep_until(due);
      if (patient_) {
        std::unique_lock<std::mutex> lock(mutex_);
        const auto placed = [&] { return placed_ < 0 || placed_ + 1 >= static_cast<long>(i); };
        pose_came_.wait_for(lock, std::chrono::seconds(1), placed);
      }
      due += std::chrono::microseconds(1000000 / kFps);
      if (patient_) due = std::max(due, std::chrono::steady_clock::now());
      PublishImu(i);
      const RosHeader header{RosTime::FromSeconds(TimeOf(i)), "cam_optical"};
      peer_.Publish(info_, EncodeCameraInfo(header, camera_));
      if (depth_ >= 0)
        peer_.Publish(depth_, EncodeRawImage(TimeOf(i), "cam_optical", Nth(i).depth));
      const std::string image = EncodeRawImage(TimeOf(i), "cam_optical", Nth(i).image);
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        sent_[static_cast<long>(i)] = std::chrono::steady_clock::now();
        if (sent_.size() > 300) sent_.erase(sent_.begin());
      }
      peer_.Publish(image_, image);
    }
  }

  FastPeer peer_;
  Camera camera_;
  std::vector<SourceFrame> frames_;
  int image_ = -1, info_ = -1, depth_ = -1, rates_ = -1, forces_ = -1;
  mutable std::mutex mutex_;
  std::map<long, std::chrono::steady_clock::time_point> sent_;  // guarded by mutex_, as the next
  long placed_ = -1;  // index of the last image with a pose
  std::condition_variable pose_came_;
  bool patient_ = false, around_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace alidade
