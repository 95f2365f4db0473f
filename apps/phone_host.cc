#include "phone_host.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"

namespace alidade {
namespace {

using SessionClock = std::chrono::steady_clock;
constexpr size_t kFrameHead = 16;  // bytes before the JPEG: number, zero, seconds

FrameMessage Text(const nlohmann::json& told) {
  return {told.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), true};
}

FrameMessage Skipped(uint32_t number, const std::string& problem = "") {
  nlohmann::json told = {{"frame", number}, {"skipped", true}};
  if (!problem.empty()) told["problem"] = problem;
  return Text(told);
}

// Creates session-1, session-2, … in `out`: the first that does not exist, so that no earlier
// result is replaced.
std::filesystem::path MakeSessionFolder(const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  for (int number = 1;; ++number) {
    const std::filesystem::path folder = out / ("session-" + std::to_string(number));
    if (std::filesystem::exists(std::filesystem::symlink_status(folder))) continue;
    // false: another process was faster
    if (std::filesystem::create_directory(folder)) return folder;
  }
}

std::vector<FrameMessage> Binary(std::vector<std::string> messages, bool of_whole = false) {
  std::vector<FrameMessage> all;
  for (std::string& message : messages) all.push_back({std::move(message), false, of_whole});
  return all;
}

}  // namespace

// A map and the thread that builds it. One page at a time is connected; a new one replaces it.
class PhoneSession : public std::enable_shared_from_this<PhoneSession> {
 public:
  PhoneSession(std::string name, int width, int height, double fov,
               const PhoneHostSettings& settings)
      : name_(std::move(name)),
        width_(width),
        height_(height),
        out_(settings.out),
        slam_(width, height, fov, settings.phone),
        left_(SessionClock::now()),
        thread_([this] { Work(); }) {}

  ~PhoneSession() {
    End();
    thread_.join();
  }

  // Lets the thread finish and write the map. Does not wait for it.
  void End() {
    const std::lock_guard lock(mutex_);
    end_ = true;
    wake_.notify_all();
  }

  bool HasEnded() const { return ended_; }  // the results are written

  bool SameSize(int width, int height) const { return width == width_ && height == height_; }

  // Connects a page and disconnects the previous one.
  int Sit(FrameTell tell, bool resumed) {
    const std::lock_guard lock(mutex_);
    if (tell_) tell_({Text({{"error", "another page has taken over this session"}})}, true);
    tell_ = std::move(tell);
    tell_({Text({{"welcome", true}, {"last", last_}, {"resumed", resumed}})}, false);
    whole_ = true;
    wake_.notify_all();
    return ++seat_;
  }

  void Leave(int seat) {
    const std::lock_guard lock(mutex_);
    if (seat != seat_) return;
    tell_ = nullptr;
    left_ = SessionClock::now();
  }

  // Seconds since the page was disconnected; negative: it is connected.
  double Alone() {
    const std::lock_guard lock(mutex_);
    if (tell_) return -1;
    return std::chrono::duration<double>(SessionClock::now() - left_).count();
  }

  void Take(int seat, const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    if (seat != seat_ || !tell_) return;
    SentFrame frame;
    if (bytes.size() <= kFrameHead) {
      tell_({Text({{"error", "an image message has 16 bytes of header and a JPEG"}})}, true);
      return;
    }
    std::memcpy(&frame.number, bytes.data(), sizeof(frame.number));  // little endian, as here
    std::memcpy(&frame.time, bytes.data() + 8, sizeof(frame.time));
    if (last_ >= 0 && frame.number <= static_cast<uint32_t>(last_)) {
      tell_({Skipped(frame.number)}, false);  // an image that was sent before
      return;
    }
    last_ = frame.number;
    frame.jpeg = bytes.substr(kFrameHead);
    if (waiting_) tell_({Skipped(waiting_->number)}, false);  // the newest one wins
    waiting_ = std::move(frame);
    wake_.notify_all();
  }

 private:
  struct SentFrame {
    uint32_t number = 0;
    double time = 0;
    std::string jpeg;
  };

  void Work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [this] { return end_ || whole_ || waiting_; });
      if (end_) break;
      if (std::exchange(whole_, false)) {
        if (tell_) tell_(Binary(slam_.WholeState(), true), false);
        continue;
      }
      const SentFrame frame = std::move(*waiting_);
      waiting_.reset();
      lock.unlock();
      std::vector<FrameMessage> told = WorkOn(frame);
      lock.lock();
      // A page that connected meanwhile gets the complete state, which includes this.
      if (tell_ && !whole_) tell_(std::move(told), false);
    }
    lock.unlock();
    Write();
    ended_ = true;
  }

  // No message of a page ends the session.
  std::vector<FrameMessage> WorkOn(const SentFrame& frame) {
    try {
      if (!std::isfinite(frame.time)) return {Skipped(frame.number, "its time is not a number")};
      const cv::Size size = JpegSize(frame.jpeg);
      if (size.width != width_ || size.height != height_)
        return {Skipped(frame.number, "it is not a JPEG of the announced size")};
      const DecodedImage decoded = DecodeJpeg(frame.jpeg, ImageUse::kGray);
      if (!decoded.problem.empty()) return {Skipped(frame.number, decoded.problem)};
      const cv::Mat image = decoded.image.isContinuous() ? decoded.image : decoded.image.clone();
      const PhoneFrame result = slam_.Track(frame.time, image.data, 1);
      std::vector<FrameMessage> messages = Binary(slam_.TakeMessages());
      messages.push_back(Text(Answer(frame.number, result)));
      return messages;
    } catch (const std::exception& error) {
      return {Skipped(frame.number, error.what())};
    }
  }

  static nlohmann::json Answer(uint32_t number, const PhoneFrame& frame) {
    const TrackResult& result = frame.result;
    nlohmann::json told = {{"frame", number},
                           {"state", StateName(result.state)},
                           {"failure", nullptr},
                           {"reason", result.state == TrackState::kTracking ? "" : result.reason()},
                           {"milliseconds", frame.milliseconds},
                           {"keyframes", frame.keyframes},
                           {"landmarks", frame.landmarks},
                           {"matches", frame.matches},
                           {"features", frame.features},
                           {"fov", frame.fov},
                           {"fovSigma", frame.fov_sigma},
                           {"pose", nullptr},
                           {"predicted", nullptr},
                           {"skipped", false}};
    if (result.failure != TrackFailure::kNone) told["failure"] = FailureName(result.failure);
    if (result.state == TrackState::kTracking) told["pose"] = NumbersOf(result.T_world_camera);
    if (result.predicted) told["predicted"] = NumbersOf(*result.predicted);
    return told;
  }

  static std::array<double, 7> NumbersOf(const Se3& pose) {
    const Eigen::Quaterniond q(pose.R);
    return {q.x(), q.y(), q.z(), q.w(), pose.t.x(), pose.t.y(), pose.t.z()};
  }

  void Write() {
    if (out_.empty()) return;
    try {
      slam_.Finish();
      if (slam_.slam().Snapshot().keyframe_count() == 0) return;
      const std::filesystem::path folder = MakeSessionFolder(out_);
      AtomicWriteFile((folder / "map.alidade").string(), slam_.slam().SaveMap());
      AtomicWriteFile((folder / "trajectory.txt").string(), slam_.Trajectory());
      AtomicWriteFile((folder / "landmarks.ply").string(), slam_.Cloud());
      std::printf("%s: map.alidade, trajectory.txt, landmarks.ply\n", folder.c_str());
    } catch (const std::exception& error) {
      std::fprintf(stderr, "alidade: warning: session %s was not written: %s\n", name_.c_str(),
                   error.what());
    }
  }

  const std::string name_;
  const int width_, height_;
  const std::string out_;
  PhoneSlam slam_;  // used by the thread only
  std::mutex mutex_;
  std::condition_variable wake_;
  FrameTell tell_;  // null: no page
  std::optional<SentFrame> waiting_;
  int64_t last_ = -1;  // number of the last accepted frame
  int seat_ = 0;
  bool whole_ = false;  // the page needs the complete state
  bool end_ = false;
  std::atomic<bool> ended_ = false;
  SessionClock::time_point left_;
  std::thread thread_;
};

namespace {

class Seat : public FrameSeat {
 public:
  Seat(std::shared_ptr<PhoneSession> session, int seat)
      : session_(std::move(session)), seat_(seat) {}
  ~Seat() override { session_->Leave(seat_); }
  void Take(std::string bytes) override { session_->Take(seat_, bytes); }

 private:
  std::shared_ptr<PhoneSession> session_;
  int seat_;
};

bool IsName(const std::string& text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

PhoneHost::PhoneHost(PhoneHostSettings settings) : settings_(std::move(settings)) {
  if (settings_.out.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(settings_.out, error);
  if (error) ThrowInput(settings_.out + " cannot be created: " + error.message());
}

PhoneHost::~PhoneHost() {
  // All are finished at the same time, then waited for.
  for (const auto& [name, session] : sessions_) session->End();
}

void PhoneHost::Warn(const std::string& message) { LogWarning(message); }

bool PhoneHost::MayEnd() {
  ending_.erase(std::remove_if(ending_.begin(), ending_.end(),
                               [](const auto& session) { return session->HasEnded(); }),
                ending_.end());
  return static_cast<int>(ending_.size()) < settings_.max_sessions;
}

PhoneHost::Sessions::iterator PhoneHost::End(Sessions::iterator session) {
  session->second->End();
  ending_.push_back(std::move(session->second));
  return sessions_.erase(session);
}

void PhoneHost::EndAbandoned() {
  const std::lock_guard lock(mutex_);
  EndAbandonedLocked();
}

void PhoneHost::EndAbandonedLocked() {
  for (auto it = sessions_.begin(); it != sessions_.end() && MayEnd();)
    it = it->second->Alone() <= settings_.keep_seconds ? std::next(it) : End(it);
}

std::pair<std::shared_ptr<PhoneSession>, bool> PhoneHost::Find(const std::string& name, int width,
                                                               int height, double fov) {
  if (const auto found = sessions_.find(name); found != sessions_.end()) {
    if (!found->second->SameSize(width, height))
      ThrowInput("this session has images of another size");
    return {found->second, true};
  }
  if (static_cast<int>(sessions_.size()) >= settings_.max_sessions) {
    // The session whose page has been disconnected longest makes room.
    auto oldest = sessions_.end();
    for (auto it = sessions_.begin(); it != sessions_.end(); ++it) {
      if (it->second->Alone() >= 0 &&
          (oldest == sessions_.end() || it->second->Alone() > oldest->second->Alone()))
        oldest = it;
    }
    if (oldest == sessions_.end())
      ThrowInput(std::to_string(settings_.max_sessions) +
                 " pages are connected already, which is the limit");
    if (!MayEnd())
      ThrowInput("the computer is finishing the maps of " + std::to_string(settings_.max_sessions) +
                 " earlier pages: try again in a minute");
    End(oldest);
  }
  auto made = std::make_shared<PhoneSession>(name, width, height, fov, settings_);
  sessions_.emplace(name, made);
  return {std::move(made), false};
}

std::unique_ptr<FrameSeat> PhoneHost::Join(const std::string& hello, FrameTell tell,
                                           std::string* problem) {
  try {
    const nlohmann::json given = nlohmann::json::parse(hello);
    const auto name = given.at("session").get<std::string>();
    const int width = given.at("width").get<int>();
    const int height = given.at("height").get<int>();
    const double fov =
        given.contains("fov") && given["fov"].is_number() ? given["fov"].get<double>() : 0;
    if (!IsName(name)) ThrowInput("session must be 32 hexadecimal digits");
    if (width < 1 || height < 1 || width > settings_.max_pixels / height)
      ThrowInput("images of " + std::to_string(width) + "x" + std::to_string(height) +
                 " pixels are not accepted");
    const std::lock_guard lock(mutex_);
    EndAbandonedLocked();
    const auto [session, resumed] = Find(name, width, height, fov);
    const int seat = session->Sit(std::move(tell), resumed);
    return std::make_unique<Seat>(session, seat);
  } catch (const Error& error) {
    *problem = error.what();
  } catch (const nlohmann::json::exception&) {
    *problem = "the first message must be JSON with session, width, height and fov";
  } catch (const std::exception& error) {
    *problem = error.what();
  }
  return nullptr;
}

}  // namespace alidade
