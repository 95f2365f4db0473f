#include "run/pose_teller.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/results/run_results.h"

namespace alidade {
namespace {

constexpr std::string_view kJson = "json:", kUdp = "udp:";

[[noreturn]] void RefusePlace(const std::string& where) {
  ThrowUsage(
      "--poses takes - (the standard output) or udp:HOST:PORT, such as udp:127.0.0.1:5005, "
      "with json: before it for JSON; not '" +
      where + "'");
}

// Sends to "HOST:PORT"; [HOST]:PORT for IPv6.
int SocketTo(const std::string& place, const std::string& where) {
  const size_t colon = place.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == place.size()) RefusePlace(where);
  std::string host = place.substr(0, colon);
  const std::string port = place.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  if (port.size() > 5 || port.find_first_not_of("0123456789") != std::string::npos ||
      std::stoi(port) < 1 || std::stoi(port) > 65535)
    RefusePlace(where);
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int problem = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); problem != 0)
    ThrowInput("--poses " + where + ": " + host + " is not found (" + gai_strerror(problem) + ")");
  int made = -1;
  for (const addrinfo* one = found; one != nullptr && made < 0; one = one->ai_next) {
    made = socket(one->ai_family, one->ai_socktype | SOCK_CLOEXEC, one->ai_protocol);
    if (made < 0) continue;
    const int yes = 1;
    setsockopt(made, SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
    if (connect(made, one->ai_addr, one->ai_addrlen) == 0) continue;
    close(made);
    made = -1;
  }
  const std::string why = std::strerror(errno);
  freeaddrinfo(found);
  if (made < 0) ThrowInput("--poses " + where + " cannot be reached (" + why + ")");
  return made;
}

// The former standard output; what is printed to stdout goes to stderr.
std::FILE* TakeStandardOutput() {
  std::fflush(stdout);
  const int kept = dup(STDOUT_FILENO);
  std::FILE* out = kept < 0 ? nullptr : fdopen(kept, "w");
  if (out == nullptr || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    ThrowInput(std::string("--poses -: the standard output cannot be used (") +
               std::strerror(errno) + ")");
  std::signal(SIGPIPE, SIG_IGN);  // the run goes on when nobody reads any more
  return out;
}

// A line of trajectory_live.txt.
std::string TumLine(const StampedPose& pose) {
  const std::string text = FormatTumTrajectory({pose});
  return text.substr(text.find('\n') + 1);
}

nlohmann::json JsonOf(const Se3& T_world_camera) {
  const Eigen::Quaterniond q = T_world_camera.Quaternion();
  const Eigen::Vector3d& t = T_world_camera.t;
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

}  // namespace

PoseTeller::PoseTeller(const std::string& where) {
  std::string place = where;
  if (place.compare(0, kJson.size(), kJson) == 0) {
    json_ = true;
    place = place.substr(kJson.size());
  }
  if (place == "-") {
    out_ = TakeStandardOutput();
  } else if (place.compare(0, kUdp.size(), kUdp) == 0) {
    socket_ = SocketTo(place.substr(kUdp.size()), where);
  } else {
    RefusePlace(where);
  }
}

PoseTeller::~PoseTeller() {
  if (out_ != nullptr) std::fclose(out_);
  if (socket_ >= 0) close(socket_);
}

void PoseTeller::Begin(const WatchedRun& run, const std::string& folder) {
  (void)folder;
  watched_.emplace(run);
}

void PoseTeller::Frame(const SourceFrame& frame, const TrackResult& result) {
  const Slam& slam = watched_->slam;
  const Eigen::Matrix3d& turn = watched_->setup.source.R_camera_rectified;
  const bool tracked = result.state == TrackState::kTracking;
  const std::vector<FramePose> last = slam.Trajectory(slam.frames() - 1);
  const MapId map = tracked && !last.empty() ? last.back().map : MapId{};
  const std::string stamp = frame.stamp.empty() ? FormatTime(frame.time) : frame.stamp;
  if (!json_) {
    if (!tracked)
      return Tell("# " + stamp + " " + StateName(result.state) + " " + FailureName(result.failure) +
                  "\n");
    // Poses of different maps are in different worlds.
    if (map_.valid() && map != map_) Tell("# map " + std::to_string(map.value) + "\n");
    map_ = map;
    return Tell(TumLine({frame.time, Mounted(result.T_world_camera, turn), frame.stamp}));
  }
  nlohmann::json line = {{"frame", frame.number},
                         {"time", frame.time},
                         {"stamp", stamp},
                         {"state", StateName(result.state)},
                         {"keyframe", result.keyframe},
                         {"matches", result.matches},
                         {"pose", nullptr},
                         {"predicted", nullptr},
                         {"map", nullptr},
                         {"covariance", nullptr},
                         {"probability", nullptr},
                         {"failure", nullptr}};
  if (tracked) {
    line["pose"] = JsonOf(Mounted(result.T_world_camera, turn));
    line["map"] = map.value;
    line["probability"] = result.quality.probability;
  } else {
    line["failure"] = FailureName(result.failure);
    if (result.predicted) line["predicted"] = JsonOf(Mounted(*result.predicted, turn));
  }
  if (result.orientation) {
    const CameraOrientation& told = *result.orientation;
    const Eigen::Quaterniond q =
        Mounted({told.R_world_camera, Eigen::Vector3d::Zero()}, turn).Quaternion();
    line["orientation"] = {{"rotation", {q.x(), q.y(), q.z(), q.w()}},
                           {"tilt_sigma", told.tilt_sigma},
                           {"heading_sigma", told.heading_sigma}};
  }
  if (!result.quality.covariance.isZero(0)) {
    // Of the error in the camera as mounted.
    Matrix6d R = Matrix6d::Zero();
    R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = turn;
    const Matrix6d covariance = R * result.quality.covariance * R.transpose();
    line["covariance"] = std::vector<double>(covariance.data(), covariance.data() + 36);
  }
  Tell(line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void PoseTeller::Tell(const std::string& line) {
  if (failed_) return;
  if (out_ == nullptr) {
    // Nobody may listen yet, or the network may be down for a moment: datagrams get lost.
    send(socket_, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    return;
  }
  if (std::fwrite(line.data(), 1, line.size(), out_) == line.size() && std::fflush(out_) == 0)
    return;
  failed_ = true;
  LogWarning(std::string("the poses cannot be told any more (") + std::strerror(errno) +
             "); the run continues");
}

}  // namespace alidade
