#include "alidade/io/camera/camera_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/base/timing.h"
#include "alidade/io/camera/live_device.h"
#include "alidade/io/camera/stream_device.h"
#include "alidade/io/camera/v4l2_camera.h"
#include "alidade/io/files/choose_calibration.h"
#include "alidade/io/gray_levels.h"
#include "alidade/io/trajectory.h"

namespace alidade {
namespace {

constexpr double kLook = 0.1;       // seconds of waiting at once
constexpr double kRetry = 0.5;      // seconds between attempts to open a device again
constexpr double kFirstImage = 10;  // seconds until a device without images is given up
constexpr double kSilent = 3;       // seconds without an image until users are told

double SecondsOf(const Stopwatch& watch) { return 1e-3 * watch.Milliseconds(); }

// What is open now, or nothing. Throws Error (input) if the device is not there.
using OpenDevice = std::function<std::unique_ptr<LiveDevice>()>;

// The first image, by which size and calibration are chosen.
LivePicture FirstPicture(LiveDevice& device, bool color, const std::string& name) {
  const Stopwatch watch;
  LivePicture picture;
  while (SecondsOf(watch) < kFirstImage) {
    const LiveDevice::Taken taken = device.Take(kLook, color, picture);
    if (taken == LiveDevice::Taken::kPicture && picture.problem.empty()) return picture;
    if (taken == LiveDevice::Taken::kGone) break;
  }
  ThrowInput(name + " gives no images" +
             (picture.problem.empty() ? std::string() : ": its image " + picture.problem));
}

// Where the left and the right image are in that of the device.
struct Halves {
  cv::Rect left, right;  // `right` is empty without stereo
};

Halves HalvesOf(cv::Size size, StereoLayout layout) {
  const int width = size.width / 2, height = size.height / 2;
  if (layout == StereoLayout::kSideBySide)
    return {{0, 0, width, size.height}, {width, 0, width, size.height}};
  if (layout == StereoLayout::kTopBottom)
    return {{0, 0, size.width, height}, {0, height, size.width, height}};
  return {{{0, 0}, size}, {}};
}

class LiveSource : public FrameSource {
 public:
  LiveSource(SourceInfo info, std::unique_ptr<LiveDevice> device, OpenDevice open, Halves halves,
             cv::Size raw_size, ImagePreparation preparation, bool color)
      : info_(std::move(info)),
        device_(std::move(device)),
        open_(std::move(open)),
        halves_(halves),
        raw_size_(raw_size),
        preparation_(std::move(preparation)),
        color_(color) {}

  const SourceInfo& Info() const override { return info_; }

  void Stop() override {
    stopped_ = true;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (device_) device_->Stop();
  }

  std::optional<SourceFrame> Next() override {
    LivePicture picture;
    const Stopwatch watch;
    for (bool told = false; !stopped_;) {
      if (!device_ && !OpenAgain()) continue;
      const LiveDevice::Taken taken = device_->Take(kLook, color_, picture);
      if (taken == LiveDevice::Taken::kPicture) return FrameOf(picture);
      if (taken == LiveDevice::Taken::kGone) Lose();
      if (device_ && !told && SecondsOf(watch) > kSilent) {
        LogWarning(info_.name + " gives no images");
        told = true;
      }
    }
    return std::nullopt;
  }

 private:
  void Lose() {
    if (stopped_) return;
    LogWarning(info_.name + " is gone; waiting until it is back");
    const std::lock_guard<std::mutex> lock(mutex_);
    device_ = nullptr;
  }

  bool OpenAgain() {
    try {
      std::unique_ptr<LiveDevice> opened = open_();
      LogWarning(info_.name + " is back: " + opened->Told());
      const std::lock_guard<std::mutex> lock(mutex_);
      device_ = std::move(opened);
      return true;
    } catch (const Error&) {
    }
    const Stopwatch watch;
    while (!stopped_ && SecondsOf(watch) < kRetry)
      std::this_thread::sleep_for(std::chrono::duration<double>(kLook));
    return false;
  }

  SourceFrame FrameOf(const LivePicture& picture) {
    if (!first_) first_ = picture.time;
    SourceFrame frame;
    frame.number = number_++;
    frame.time = picture.time - *first_;
    frame.stamp = FormatTime(frame.time);
    frame.problem = picture.problem;
    if (frame.problem.empty() && picture.image.size() != raw_size_)
      frame.problem = "has another size than the first";
    if (!frame.problem.empty()) {
      frame.problem = info_.name + ": image " + std::to_string(frame.number) + " " + frame.problem;
      return frame;
    }
    const cv::Mat gray = levels_.To8Bit(picture.image, frame.time);
    frame.image = preparation_.Left(gray(halves_.left).clone());
    if (!picture.color.empty())
      frame.color = preparation_.Left(levels_.ColorTo8Bit(picture.color)(halves_.left).clone());
    if (info_.sensor == Sensor::kStereo)
      frame.right = preparation_.Right(gray(halves_.right).clone());
    return frame;
  }

  SourceInfo info_;
  std::mutex mutex_;                    // of Stop() and who replaces device_
  std::unique_ptr<LiveDevice> device_;  // null: awaited
  OpenDevice open_;
  Halves halves_;
  cv::Size raw_size_;  // of the device's images
  ImagePreparation preparation_;
  const bool color_;
  GrayLevels levels_;
  std::optional<double> first_;  // time of the first image, seconds of the device's clock
  int number_ = 0;               // of the next frame
  std::atomic<bool> stopped_{false};
};

Sensor SensorOf(StereoLayout layout, const SourceOptions& options, const std::string& source) {
  const bool stereo = layout != StereoLayout::kNone;
  const Sensor sensor = options.sensor.value_or(stereo ? Sensor::kStereo : Sensor::kMono);
  if (sensor == Sensor::kRgbd) ThrowUsage(source + " has no depth: use --sensor mono or stereo");
  if (sensor == Sensor::kStereo && !stereo)
    ThrowUsage(source + " is one camera: a stereo camera needs ?stereo=side-by-side or top-bottom");
  return sensor;
}

std::unique_ptr<FrameSource> MakeSource(const std::string& name, const std::string& source,
                                        StereoLayout layout, OpenDevice open,
                                        std::unique_ptr<LiveDevice> device,
                                        const SourceOptions& options) {
  SourceInfo info;
  info.name = name;
  info.kind = "camera";
  info.live = true;
  info.sensor = SensorOf(layout, options, source);
  const bool stereo = info.sensor == Sensor::kStereo;
  const LivePicture first = FirstPicture(*device, false, source);
  const Halves halves = HalvesOf(first.image.size(), layout);
  auto [calibration, guessed, lens_told] =
      ChooseCalibration(std::nullopt, halves.left.size(), options);
  if (stereo && !calibration.right && !(calibration.baseline > 0))
    ThrowUsage(source + ": stereo needs a calibration of both cameras (--camera FILE)");
  if (device->FramesPerSecond() > 0) calibration.fps = device->FramesPerSecond();
  ImagePreparation preparation(calibration, info.sensor);
  info.camera = preparation.camera();
  info.R_camera_rectified = preparation.R_camera_rectified();
  info.camera_guessed = guessed;
  info.lens_told = lens_told;
  info.told = device->Told() + (calibration.told.empty() ? "" : "\n" + calibration.told);
  return std::make_unique<LiveSource>(std::move(info), std::move(device), std::move(open), halves,
                                      first.image.size(), std::move(preparation), options.color);
}

constexpr std::array<std::string_view, 7> kSchemes = {"rtsp://", "rtsps://", "http://", "https://",
                                                      "rtmp://", "srt://",   "udp://"};

}  // namespace

bool IsStreamSource(const std::string& source) {
  return std::any_of(kSchemes.begin(), kSchemes.end(), [&](std::string_view scheme) {
    return source.compare(0, scheme.size(), scheme) == 0;
  });
}

std::unique_ptr<FrameSource> OpenCameraSource(const std::string& source,
                                              const SourceOptions& options) {
  const CameraRequest request = ParseCameraSource(source);
  std::unique_ptr<LiveDevice> device = OpenV4l2Camera(request);
  const std::vector<CameraDevice> all = FindCameras();
  const auto own = std::find_if(all.begin(), all.end(), [&](const CameraDevice& camera) {
    return camera.path == request.device;
  });
  if (own == all.end()) ThrowInput(request.device + " was unplugged");
  const OpenDevice open = [request, camera = *own] { return OpenV4l2Camera(request, &camera); };
  const std::string number = request.device.substr(request.device.find_first_of("0123456789"));
  return MakeSource("camera" + number, source, request.stereo, open, std::move(device), options);
}

std::unique_ptr<FrameSource> OpenStreamSource(const std::string& address,
                                              const SourceOptions& options) {
  const OpenDevice open = [address] { return OpenStreamDevice(address); };
  return MakeSource("stream", AddressToShow(address), StereoLayout::kNone, open, open(), options);
}

}  // namespace alidade
