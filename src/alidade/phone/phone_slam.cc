#include "alidade/phone/phone_slam.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "alidade/features/color.h"
#include "alidade/io/cloud.h"
#include "alidade/io/trajectory.h"
#include "alidade/version.h"

namespace alidade {
namespace {

// Degrees along the longer side; typical of phones' main cameras.
constexpr double kAssumedFov = 66;
constexpr double kDegree = std::numbers::pi / 180;
constexpr size_t kMostWaiting = 32 << 20;  // bytes of messages that were not taken
constexpr int kMostKeyFrames = 2000;       // about 200 MB

Camera AssumedCamera(int width, int height, double fov) {
  if (fov > 0) return Camera::FromFieldOfView(width, height, fov);
  Camera camera = Camera::FromFieldOfView(std::max(width, height), 1, kAssumedFov);
  const double focal = camera.fx;
  camera = Camera::FromFieldOfView(width, height, kAssumedFov);
  camera.fx = camera.fy = focal;
  return camera;
}

}  // namespace

PhoneSettings PhoneSettings::Default(bool threaded) {
  PhoneSettings settings;
  settings.slam.ApplyProfile("phone");
  settings.slam.threaded = threaded;
  settings.slam.mapper.max_keyframes = kMostKeyFrames;
  return settings;
}

void PhoneSettings::SetLines(const std::string& lines) {
  for (size_t begin = 0; begin < lines.size();) {
    const size_t end = std::min(lines.find('\n', begin), lines.size());
    const std::string line = lines.substr(begin, end - begin);
    const size_t equal = line.find('=');
    if (equal != std::string::npos) slam.Set(line.substr(0, equal), line.substr(equal + 1));
    begin = end + 1;
  }
}

PhoneSlam::PhoneSlam(int width, int height, double fov, PhoneSettings settings)
    : settings_(std::move(settings)), camera_(AssumedCamera(width, height, fov)), known_(fov > 0) {
  if (!known_) settings_.slam.EnableSelfCalibration();
  Begin();
}

PhoneSlam::PhoneSlam(const Camera& camera, PhoneSettings settings)
    : settings_(std::move(settings)), camera_(camera), known_(true) {
  Begin();
}

PhoneSlam::~PhoneSlam() = default;

void PhoneSlam::Begin() {
  std::shared_ptr<Detector> detector = settings_.detector;
  if (!settings_.detector_classes.empty()) {
    settings_.slam.dynamics.mode = DynamicsMode::kFull;
    detector = detector_ = std::make_shared<LateDetector>(settings_.detector_classes);
  }
  slam_ = std::make_unique<Slam>(camera_, settings_.slam, detector);
  source_.program = std::string("alidade ") + ALIDADE_VERSION;
  source_.source = "camera";
  source_.sensor = "mono";
  source_.unit = "map units";
  source_.live = true;
}

PhoneFrame PhoneSlam::Track(double time, const uint8_t* pixels, int channels) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const cv::Mat image(camera_.height, camera_.width, channels == 1 ? CV_8UC1 : CV_8UC4,
                      const_cast<uint8_t*>(pixels));
  FrameInput input;
  input.time = time;
  input.imu = std::exchange(moved_, {});
  if (channels == 1) {
    input.image = image;
  } else {
    input.image = GrayOf(image, true);
    if (settings_.slam.WantsColor()) input.color = BgrOf(image, true);
  }
  PhoneFrame frame;
  frame.result = slam_->Track(input);
  frame.number = frames_++;
  const StreamFrame told = FrameAsLeft(*slam_, frame.number, time, frame.result, latest_);
  const MapSnapshot& map = told.map;
  frame.keyframes = map.keyframe_count();
  frame.landmarks = map.landmark_count();
  frame.maps = static_cast<int>(map.Maps().size());
  frame.features = static_cast<int>(told.features.size());
  frame.matches = frame.result.matches;
  if (encoder_) Tell(encoder_->Add(told));
  TellLens(frame);
  frame.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return frame;
}

// Field of view of the images as passed to Track().
void PhoneSlam::TellLens(PhoneFrame& frame) const {
  const Camera used = slam_->camera();
  frame.fov = 2 / kDegree * std::atan(used.width / (2 * used.fx));
  if (known_) return;
  const std::optional<CameraEstimate> found = slam_->camera_found();
  const double focal_sigma = found ? found->focal_sigma : settings_.slam.refine.focal_sigma;
  // d fov / d log f = -sin fov
  frame.fov_sigma = focal_sigma * std::sin(frame.fov * kDegree) / kDegree;
  frame.camera_changes = slam_->camera_changes();
}

void PhoneSlam::Moved(std::span<const ImuSample> readings) {
  moved_.insert(moved_.end(), readings.begin(), readings.end());
}

void PhoneSlam::Detected(int number, std::vector<Detection> detections) {
  if (!detector_) return;
  // Convert from pixels of the images passed to Track() to pixels of the images SLAM works on.
  const Camera used = slam_->camera();
  const float x = static_cast<float>(used.width) / static_cast<float>(camera_.width);
  const float y = static_cast<float>(used.height) / static_cast<float>(camera_.height);
  for (Detection& found : detections) {
    const cv::Rect2f& box = found.box;
    found.box = {box.x * x, box.y * y, box.width * x, box.height * y};
  }
  detector_->Bring({slam_->first_number() + number, std::move(detections)});
}

void PhoneSlam::Finish() {
  slam_->Finish();
  if (encoder_) Tell(encoder_->End(slam_->Snapshot(), slam_->camera()));
}

void PhoneSlam::BeginMessages() {
  source_.camera = slam_->camera();
  encoder_ = std::make_unique<StreamEncoder>(source_, settings_.stream);
  Tell({encoder_->Hello()});
}

void PhoneSlam::Tell(std::vector<std::string> messages) {
  for (std::string& message : messages) {
    waiting_ += message.size();
    messages_.push_back(std::move(message));
  }
  if (waiting_ <= kMostWaiting) return;
  messages_.clear();
  waiting_ = 0;
  behind_ = true;
}

std::vector<std::string> PhoneSlam::TakeMessages() {
  if (!encoder_) BeginMessages();
  waiting_ = 0;
  if (!std::exchange(behind_, false)) return std::exchange(messages_, {});
  messages_.clear();
  return encoder_->Whole();
}

std::vector<std::string> PhoneSlam::WholeState() {
  if (!encoder_) BeginMessages();
  messages_.clear();
  waiting_ = 0;
  behind_ = false;
  return encoder_->Whole();
}

std::string PhoneSlam::Trajectory() const {
  alidade::Trajectory trajectory;
  for (const FramePose& pose : slam_->Trajectory()) {
    if (pose.tracked) trajectory.push_back({pose.time, pose.T_world_camera, {}});
  }
  return FormatTumTrajectory(trajectory);
}

std::string PhoneSlam::Cloud() const {
  const MapSnapshot map = slam_->Snapshot();
  alidade::Cloud cloud;
  for (LandmarkId id : map.Landmarks()) cloud.points.push_back(map.Find(id)->p_world.cast<float>());
  return EncodePly(cloud, CloudFormat::kBinary);
}

}  // namespace alidade
