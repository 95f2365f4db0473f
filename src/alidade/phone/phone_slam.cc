#include "alidade/phone/phone_slam.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "alidade/io/cloud.h"
#include "alidade/io/trajectory.h"
#include "alidade/version.h"

namespace alidade {
namespace {

constexpr double kAssumedFov = 66;  // degrees, along the longer side: most phones' main camera
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kWaryOfTurns = 0.6;       // relative uncertainty of an assumed focal length
constexpr size_t kMostWaiting = 32 << 20;  // bytes of messages that nobody took
constexpr int kMostKeyFrames = 2000;       // some 200 MB

Camera AssumedCamera(int width, int height, double fov) {
  if (fov > 0) return Camera::FromFieldOfView(width, height, fov);
  Camera camera = Camera::FromFieldOfView(std::max(width, height), 1, kAssumedFov);
  const double focal = camera.fx;
  camera = Camera::FromFieldOfView(width, height, kAssumedFov);
  camera.fx = camera.fy = focal;
  return camera;
}

MapId LargestMap(const MapSnapshot& map) {
  MapId largest;
  size_t most = 0;
  for (MapId id : map.Maps()) {
    const size_t count = map.KeyFramesOf(id).size();
    if (count > most) {
      most = count;
      largest = id;
    }
  }
  return largest;
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
  if (!known_) {
    focal_sigma_ = settings_.calibrate.adjust.focal_sigma;
    settings_.slam.start.two_view.lens_uncertainty = kWaryOfTurns;
    settings_.slam.readout.enabled =
        false;  // a wrong lens bends pictures as a rolling shutter does
  }
  Begin();
}

PhoneSlam::PhoneSlam(const Camera& camera, PhoneSettings settings)
    : settings_(std::move(settings)), camera_(camera), known_(true) {
  Begin();
}

PhoneSlam::~PhoneSlam() = default;

void PhoneSlam::Begin() {
  focal_ = camera_.fx;
  std::shared_ptr<Detector> detector = settings_.detector;
  if (!settings_.detector_classes.empty()) {
    settings_.slam.dynamics.mode = DynamicsMode::kFull;
    detector = detector_ = std::make_shared<LateDetector>(settings_.detector_classes);
  }
  slam_ = std::make_unique<Slam>(camera_, settings_.slam, detector);
  first_ = frames_;
  StreamSource source;
  source.program = std::string("alidade ") + ALIDADE_VERSION;
  source.source = "camera";
  source.sensor = "mono";
  source.unit = "map units";
  source.live = true;
  source.camera = slam_->camera();
  const bool wanted = encoder_ != nullptr;
  source_ = source;
  encoder_.reset();
  if (wanted) BeginMessages();
  latest_ = {};
  before_.reset();
  ask_at_ = settings_.first_keyframes;
}

PhoneFrame PhoneSlam::Track(const uint8_t* pixels, int channels, double time) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const cv::Mat image(camera_.height, camera_.width, channels == 1 ? CV_8UC1 : CV_8UC4,
                      const_cast<uint8_t*>(pixels));
  FrameInput input;
  input.time = time;
  if (channels == 1) {
    input.image = image;
  } else {
    cv::cvtColor(image, input.image, cv::COLOR_RGBA2GRAY);
    if (settings_.slam.WantsColor()) cv::cvtColor(image, input.color, cv::COLOR_RGBA2BGR);
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
  if (!known_) AskForCamera();
  frame.fov = 2 / kDegree * std::atan(camera_.width / (2 * focal_));
  // d fov / d log f = -sin fov.
  frame.fov_sigma = focal_sigma_ * std::sin(frame.fov * kDegree) / kDegree;
  frame.restarts = restarts_;
  frame.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  return frame;
}

void PhoneSlam::AskForCamera() {
  const MapSnapshot map = slam_->Snapshot();
  const MapId largest = LargestMap(map);
  if (!largest.valid()) return;
  const auto now = static_cast<int>(map.KeyFramesOf(largest).size());
  if (now < ask_at_) return;
  ask_at_ = static_cast<int>(std::ceil(now * settings_.growth));
  const Camera used = slam_->camera();
  const MeasurementNoise& noise = settings_.slam.mapper.noise;
  const CameraEstimate found =
      EstimateCamera(LensWindowsOf(map, largest, used, noise, settings_.calibrate), used, noise,
                     settings_.calibrate);
  if (found.keyframes == 0 || found.focal_sigma > settings_.max_sigma) return;
  const double off = std::abs(std::log(found.camera.fx / used.fx));
  const bool agree = before_ && std::abs(std::log(found.camera.fx / before_->camera.fx)) <=
                                    2 * std::hypot(found.focal_sigma, before_->focal_sigma);
  before_ = found;
  if (!agree) return;
  // Of the pictures as they come, which may be larger than those that are worked on.
  const double scale = static_cast<double>(camera_.width) / used.width;
  focal_ = found.camera.fx * scale;
  focal_sigma_ = std::hypot(found.focal_sigma, settings_.model_sigma);
  if (off <= settings_.max_off || off <= 2 * found.focal_sigma ||
      restarts_ >= settings_.max_restarts)
    return;
  camera_.fx = camera_.fy = focal_;
  camera_.distortion = found.camera.distortion;
  camera_.cx = (found.camera.cx + 0.5) * scale - 0.5;
  camera_.cy = (found.camera.cy + 0.5) * camera_.height / used.height - 0.5;
  settings_.slam.start.two_view.lens_uncertainty = 3 * found.focal_sigma;
  ++restarts_;
  Begin();
}

void PhoneSlam::Detected(int number, std::vector<Detection> detections) {
  if (!detector_ || number < first_) return;  // of a map that was begun anew since
  // From pixels of the picture as it came to those that are worked on.
  const Camera used = slam_->camera();
  const float x = static_cast<float>(used.width) / static_cast<float>(camera_.width);
  const float y = static_cast<float>(used.height) / static_cast<float>(camera_.height);
  for (Detection& found : detections) {
    const cv::Rect2f& box = found.box;
    found.box = {box.x * x, box.y * y, box.width * x, box.height * y};
  }
  detector_->Bring({slam_->first_number() + number - first_, std::move(detections)});
}

void PhoneSlam::Finish() {
  slam_->Finish();
  if (encoder_) Tell(encoder_->End(slam_->Snapshot()));
}

void PhoneSlam::BeginMessages() {
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
