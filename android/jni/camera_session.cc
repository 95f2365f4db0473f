#include "camera_session.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/detect/onnx/open_detector.h"

namespace alidade {
namespace {

// Phones have two to four fast cores; a parallel loop on slow cores as well would wait for the
// slowest.
constexpr int kMostThreads = 4;
constexpr int kMostSide = 4096;          // pixels
constexpr size_t kMostReadings = 10000;  // kept while no image comes

std::unique_ptr<PhoneSlam> MakeSlam(int width, int height, const LensNumbers& lens,
                                    const PhoneSettings& settings) {
  if (lens.size() <= 1) {
    return std::make_unique<PhoneSlam>(width, height, lens.empty() ? 0 : lens[0], settings);
  }
  if (lens.size() != 9) ThrowUsage("a lens is told by 0, 1 or 9 numbers");
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = lens[0];
  camera.fy = lens[1];
  camera.cx = lens[2];
  camera.cy = lens[3];
  std::copy(lens.begin() + 4, lens.end(), camera.distortion.begin());
  return std::make_unique<PhoneSlam>(camera, settings);
}

}  // namespace

CameraSession::CameraSession(int width, int height, const LensNumbers& lens,
                             const std::string& settings, const std::string& detector)
    : width_(width),
      height_(height),
      lens_(lens),
      detector_(detector),
      settings_(PhoneSettings::Default(true)),
      view_(MakeSceneView()) {
  if (width < 1 || height < 1 || width > kMostSide || height > kMostSide) {
    ThrowUsage("images of " + std::to_string(width) + "x" + std::to_string(height) +
               " pixels are not accepted: sides must have 1 to " + std::to_string(kMostSide));
  }
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  SetThreadCount(std::clamp(cores, 1, kMostThreads));
  settings_.SetLines(settings);
  slam_ = MakeSlam(width, height, lens, settings_);
  const size_t pixels = static_cast<size_t>(width) * height;
  for (Pixels* picture : {&waiting_, &working_, &shown_, &drawn_}) picture->resize(pixels);
  thread_ = std::thread([this] { Work(); });
}

CameraSession::~CameraSession() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CameraSession::Offer(const uint8_t* plane, size_t bytes, int row_stride, double time) {
  const auto width = static_cast<size_t>(width_);
  const auto stride = static_cast<size_t>(std::max(row_stride, 0));
  if (stride < width || bytes < stride * (height_ - 1) + width) {
    ThrowInput("a picture of " + std::to_string(bytes) + " bytes, rows " +
               std::to_string(row_stride) + " apart, has no " + std::to_string(width_) + "x" +
               std::to_string(height_) + " pixels");
  }
  if (!std::isfinite(time)) ThrowInput("the time of an image is not a number");
  {
    const std::lock_guard lock(mutex_);
    if (gone_) throw StateError("the camera is gone: cameraBack() comes before the next picture");
    if (waits_) ++numbers_.skipped;
    for (int row = 0; row < height_; ++row) {
      std::memcpy(waiting_.data() + row * width, plane + row * stride, width);
    }
    waiting_time_ = time;
    waits_ = true;
  }
  changed_.notify_all();
}

void CameraSession::Moved(std::span<const double> readings) {
  constexpr size_t kNumbers = 7;
  if (readings.size() % kNumbers != 0)
    ThrowUsage("inertial readings have 7 numbers each: " + std::to_string(readings.size()) +
               " are not a multiple");
  const std::lock_guard lock(mutex_);
  if (moved_.size() > kMostReadings) moved_.clear();
  for (size_t i = 0; i < readings.size(); i += kNumbers) {
    const double* r = readings.data() + i;
    moved_.push_back({r[0], {r[1], r[2], r[3]}, {r[4], r[5], r[6]}});
  }
}

void CameraSession::CameraGone() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
}

void CameraSession::CameraBack() {
  const std::lock_guard lock(mutex_);
  if (gone_) cut_ = true;
  gone_ = false;
}

void CameraSession::Work() {
  if (!detector_.empty()) OpenDetectorFile();
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return end_ || waits_; });
    if (end_) return;
    working_.swap(waiting_);
    const double time = waiting_time_;
    const bool cut = std::exchange(cut_, false);
    waits_ = false;
    in_work_ = true;
    lock.unlock();
    WorkOn(time, cut);
    lock.lock();
    in_work_ = false;
    changed_.notify_all();
  }
}

void CameraSession::OpenDetectorFile() {
  try {
    PhoneSettings settings = settings_;
    settings.detector = OpenDetector(detector_);
    settings.slam.dynamics.mode = DynamicsMode::kFull;
    std::unique_ptr<PhoneSlam> slam = MakeSlam(width_, height_, lens_, settings);
    const std::lock_guard lock(slam_mutex_);
    slam_ = std::move(slam);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    words_ = std::string("people are not left out: ") + error.what();
  }
}

void CameraSession::WorkOn(double time, bool cut) {
  bool wanted = false;
  std::vector<ImuSample> moved;
  {
    const std::lock_guard lock(mutex_);
    wanted = std::exchange(wanted_, false);
    moved = std::exchange(moved_, {});
  }
  try {
    PhoneFrame frame;
    InertialReport inertial;
    std::vector<std::string> messages;
    {
      const std::lock_guard lock(slam_mutex_);
      if (cut) slam_->slam().Reset();
      slam_->Moved(moved);
      frame = slam_->Track(time, working_.data(), 1);
      inertial = slam_->slam().Inertial();
      if (wanted) messages = slam_->TakeMessages();
    }
    const std::lock_guard lock(mutex_);
    ++numbers_.frames;
    numbers_.frame = std::move(frame);
    numbers_.inertial = std::move(inertial);
    if (!numbers_.frame.result.warning.empty()) words_ = numbers_.frame.result.warning;
    working_.swap(shown_);
    fresh_ = true;
    for (std::string& message : messages) messages_.push_back(std::move(message));
  } catch (const std::exception& error) {
    Fail(error.what());
  } catch (...) {
    Fail("unknown error");
  }
}

void CameraSession::Fail(const std::string& what) {
  const std::lock_guard lock(mutex_);
  ++numbers_.failed;
  words_ = what;
}

void CameraSession::SurfaceCreated() {
  view_->ContextLost();
  surface_ = true;
}

void CameraSession::SurfaceGone() {
  if (surface_) view_->Release();
  surface_ = false;
}

void CameraSession::SurfaceChanged(int width, int height) {
  view_->Resize(std::max(width, 1), std::max(height, 1));
}

bool CameraSession::Draw(int rotation) {
  if (rotation % 90 != 0 || rotation < 0 || rotation >= 360) {
    ThrowUsage("pictures are turned by 0, 90, 180 or 270 degrees, not " + std::to_string(rotation));
  }
  if (!surface_) throw StateError("nothing can be drawn before the surface is there");
  std::vector<std::string> messages;
  bool picture = false, news = false;
  {
    const std::lock_guard lock(mutex_);
    wanted_ = true;
    messages.swap(messages_);
    news = std::exchange(fresh_, false);
    if (news) shown_.swap(drawn_);
    picture = numbers_.frames > 0;
  }
  for (const std::string& message : messages) scene_.Take(message);
  const bool turned = std::exchange(rotation_, rotation) != rotation;
  ViewFrame frame;
  frame.scene = &scene_;
  if (news || (turned && picture)) frame.luma = drawn_.data();
  frame.width = width_;
  frame.height = height_;
  frame.rotation = rotation;
  view_->Draw(frame);
  return picture;
}

SessionNumbers CameraSession::Numbers() const {
  const std::lock_guard lock(mutex_);
  return numbers_;
}

std::string CameraSession::Words() const {
  const std::lock_guard lock(mutex_);
  return words_;
}

std::string CameraSession::Map() const {
  const std::lock_guard lock(slam_mutex_);
  return slam_->slam().SaveMap();
}

std::string CameraSession::Trajectory() const {
  const std::lock_guard lock(slam_mutex_);
  return slam_->Trajectory();
}

void CameraSession::WaitUntilIdle() const {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !waits_ && !in_work_; });
}

}  // namespace alidade
