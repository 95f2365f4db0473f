// The functions that JavaScript calls (web/core). They pass numbers and pointers into the module's
// memory; results must be read before the next call. No exception leaves the module: a failed call
// returns an error value, and alidade_error() the reason.
#include <emscripten.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/log.h"
#include "alidade/base/parallel.h"
#include "alidade/map/landmark_covariance.h"
#include "alidade/phone/phone_slam.h"
#include "frame_numbers.h"

namespace {

using alidade::PhoneFrame;
using alidade::PhoneSlam;

// One SLAM session with the buffers of its last results.
struct Session {
  Session(std::unique_ptr<PhoneSlam> of, int width, int height)
      : slam(std::move(of)), pixels(static_cast<size_t>(width) * height * 4) {}
  std::unique_ptr<PhoneSlam> slam;
  std::vector<uint8_t> pixels;
  FrameNumbers numbers;
  std::string bytes;
  std::vector<float> features;
  InertialNumbers inertial;
  std::array<double, 9> covariance{};
};

std::string last_error;

template <typename Call>
auto Guarded(Call&& call, decltype(call()) failed) -> decltype(call()) {
  try {
    return call();
  } catch (const std::exception& error) {
    last_error = error.what();
  } catch (...) {
    last_error = "unknown error";
  }
  return failed;
}

// Concatenated messages, each after its length as 32-bit little endian.
std::string Joined(const std::vector<std::string>& messages) {
  std::string all;
  for (const std::string& message : messages) {
    const auto size = static_cast<uint32_t>(message.size());
    all.append(reinterpret_cast<const char*>(&size), sizeof(size));
    all += message;
  }
  return all;
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

alidade::PhoneSettings SettingsOf(int threads, const char* settings, const char* classes) {
  alidade::SetThreadCount(std::max(1, threads));
  auto phone = alidade::PhoneSettings::Default(threads > 1);
  phone.SetLines(settings);
  phone.detector_classes = Lines(classes);
  return phone;
}

}  // namespace

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* alidade_error() { return last_error.c_str(); }

// `fov`: horizontal field of view, degrees; 0: unknown. `settings`: lines of name=value, as after
// --set. `classes`: class names of an external detector (alidade_detected), one per line; empty:
// none. Returns null on failure.
EMSCRIPTEN_KEEPALIVE Session* alidade_new(int width, int height, double fov, int threads,
                                          const char* settings, const char* classes) {
  return Guarded(
      [&] {
        const alidade::PhoneSettings phone = SettingsOf(threads, settings, classes);
        return new Session(std::make_unique<PhoneSlam>(width, height, fov, phone), width, height);
      },
      static_cast<Session*>(nullptr));
}

// `camera`: fx fy cx cy k1 k2 p1 p2 k3.
EMSCRIPTEN_KEEPALIVE Session* alidade_new_calibrated(int width, int height, const double* camera,
                                                     int threads, const char* settings,
                                                     const char* classes) {
  return Guarded(
      [&] {
        alidade::Camera c;
        c.width = width;
        c.height = height;
        c.fx = camera[0];
        c.fy = camera[1];
        c.cx = camera[2];
        c.cy = camera[3];
        std::copy(camera + 4, camera + 9, c.distortion.begin());
        const alidade::PhoneSettings phone = SettingsOf(threads, settings, classes);
        return new Session(std::make_unique<PhoneSlam>(c, phone), width, height);
      },
      static_cast<Session*>(nullptr));
}

EMSCRIPTEN_KEEPALIVE void alidade_delete(Session* session) { delete session; }

// Buffer for the next image, up to 4 bytes per pixel.
EMSCRIPTEN_KEEPALIVE uint8_t* alidade_pixels(Session* session) { return session->pixels.data(); }

// Returns null on failure.
EMSCRIPTEN_KEEPALIVE const FrameNumbers* alidade_track(Session* session, int channels,
                                                       double time) {
  return Guarded(
      [&]() -> const FrameNumbers* {
        const PhoneFrame frame = session->slam->Track(time, session->pixels.data(), channels);
        const alidade::TrackResult& result = frame.result;
        const alidade::Se3 pose = result.predicted.value_or(result.T_world_camera);
        const Eigen::Quaterniond q(pose.R);
        const alidade::CameraOrientation oriented =
            result.orientation.value_or(alidade::CameraOrientation{});
        const Eigen::Quaterniond o(oriented.R_world_camera);
        const bool tracking = result.state == alidade::TrackState::kTracking;
        session->numbers = {.number = static_cast<double>(frame.number),
                            .state = static_cast<double>(result.state),
                            .failure = static_cast<double>(result.failure),
                            .placed = tracking || result.predicted ? 1.0 : 0.0,
                            .predicted = result.predicted ? 1.0 : 0.0,
                            .keyframes = static_cast<double>(frame.keyframes),
                            .landmarks = static_cast<double>(frame.landmarks),
                            .matches = static_cast<double>(frame.matches),
                            .features = static_cast<double>(frame.features),
                            .maps = static_cast<double>(frame.maps),
                            .milliseconds = frame.milliseconds,
                            .fov = frame.fov,
                            .fov_sigma = frame.fov_sigma,
                            .camera_changes = static_cast<double>(frame.camera_changes),
                            .tx = pose.t.x(),
                            .ty = pose.t.y(),
                            .tz = pose.t.z(),
                            .qx = q.x(),
                            .qy = q.y(),
                            .qz = q.z(),
                            .qw = q.w(),
                            .oriented = result.orientation ? 1.0 : 0.0,
                            .ox = o.x(),
                            .oy = o.y(),
                            .oz = o.z(),
                            .ow = o.w(),
                            .tilt_sigma = oriented.tilt_sigma,
                            .heading_sigma = oriented.heading_sigma};
        return &session->numbers;
      },
      nullptr);
}

// Features of the last frame: x, y (pixels) and 1 if matched to a landmark, at `*at`. Returns their
// number.
EMSCRIPTEN_KEEPALIVE int alidade_features(Session* session, const float** at) {
  session->features.clear();
  for (const alidade::FeatureUse& use : session->slam->slam().Features()) {
    session->features.push_back(use.x);
    session->features.push_back(use.y);
    session->features.push_back(use.matched ? 1.0f : 0.0f);
  }
  *at = session->features.data();
  return static_cast<int>(session->features.size() / 3);
}

// Passes the detections in image `number`, 6 floats each: class, score, x, y, width, height.
// Negative on failure.
EMSCRIPTEN_KEEPALIVE int alidade_detected(Session* session, int number, const float* found,
                                          int count) {
  return Guarded(
      [&] {
        std::vector<alidade::Detection> detections;
        for (const float* d = found; d != found + 6 * count; d += 6)
          detections.push_back({static_cast<int>(d[0]), d[1], {d[2], d[3], d[4], d[5]}});
        session->slam->Detected(number, std::move(detections));
        return 0;
      },
      -1);
}

// Passes readings of the inertial sensor since the last call, 7 numbers each: time (seconds),
// angular rate x y z (rad/s), specific force x y z (m/s²). They are used with the next image.
// Negative on failure.
EMSCRIPTEN_KEEPALIVE int alidade_moved(Session* session, const double* readings, int count) {
  return Guarded(
      [&] {
        std::vector<alidade::ImuSample> samples;
        for (const double* r = readings; r != readings + 7 * count; r += 7)
          samples.push_back({r[0], {r[1], r[2], r[3]}, {r[4], r[5], r[6]}});
        session->slam->Moved(samples);
        return 0;
      },
      -1);
}

// Returns null on failure.
EMSCRIPTEN_KEEPALIVE const InertialNumbers* alidade_inertial(Session* session) {
  return Guarded(
      [&]() -> const InertialNumbers* {
        const alidade::InertialReport report = session->slam->slam().Inertial();
        const Eigen::Vector3d gravity = report.gravity.value_or(Eigen::Vector3d::Zero());
        session->inertial = {.samples = static_cast<double>(report.samples),
                             .metric = report.metric ? 1.0 : 0.0,
                             .scale_sigma = report.scale_sigma,
                             .falls = report.gravity ? 1.0 : 0.0,
                             .gx = gravity.x(),
                             .gy = gravity.y(),
                             .gz = gravity.z(),
                             .gravity_sigma = report.gravity_sigma,
                             .time_offset = report.model.time_offset,
                             .time_offset_sigma = report.time_offset_sigma};
        return &session->inertial;
      },
      nullptr);
}

// Nine numbers; null: not known (LandmarkCovariance()), or a failure.
EMSCRIPTEN_KEEPALIVE const double* alidade_covariance(Session* session, int landmark) {
  return Guarded(
      [&]() -> const double* {
        const alidade::Slam& slam = session->slam->slam();
        const auto covariance = alidade::LandmarkCovariance(
            slam.Snapshot(), alidade::LandmarkId{static_cast<uint32_t>(landmark)}, slam.camera());
        if (!covariance) return nullptr;
        std::copy(covariance->data(), covariance->data() + 9, session->covariance.begin());
        return session->covariance.data();
      },
      nullptr);
}

enum Bytes {
  kMessages = 0,
  kTrajectory = 1,
  kMap = 2,
  kCloud = 3,
  kInertialMissing = 4,
  kInertialLeftOut = 5
};

// Sets `*at` to the requested bytes and returns their number; negative on failure.
EMSCRIPTEN_KEEPALIVE int alidade_bytes(Session* session, int what, const char** at) {
  return Guarded(
      [&] {
        PhoneSlam& slam = *session->slam;
        session->bytes = what == kMessages          ? Joined(slam.TakeMessages())
                         : what == kTrajectory      ? slam.Trajectory()
                         : what == kMap             ? slam.slam().SaveMap()
                         : what == kInertialMissing ? slam.slam().Inertial().missing
                         : what == kInertialLeftOut ? slam.slam().Inertial().left_out
                                                    : slam.Cloud();
        *at = session->bytes.data();
        return static_cast<int>(session->bytes.size());
      },
      -1);
}

EMSCRIPTEN_KEEPALIVE int alidade_finish(Session* session) {
  return Guarded(
      [&] {
        session->slam->Finish();
        return 0;
      },
      -1);
}

}  // extern "C"
