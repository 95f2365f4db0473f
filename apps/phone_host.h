// Processes the images that pages send (alidade phone --connected), with one map per page.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "alidade/phone/phone_slam.h"
#include "alidade/serve/frame_host.h"

namespace alidade {

class PhoneSession;

struct PhoneHostSettings {
  int max_sessions = 4;        // each has a thread, and some 200 MB for a large map
  double keep_seconds = 300;   // how long a session waits for a disconnected page
  int max_pixels = 4'000'000;  // of an image
  // Folder for the results: at its end each session writes to a new folder session-N in it. Empty:
  // no results.
  std::string out;
  PhoneSettings phone = PhoneSettings::Default(true);
};

class PhoneHost : public FrameHost {
 public:
  explicit PhoneHost(PhoneHostSettings settings);
  ~PhoneHost() override;  // ends and writes all sessions
  // Ends the sessions whose page has been disconnected for longer than keep_seconds. Does not wait:
  // each is finished and written in its own thread, at most max_sessions at a time.
  void EndAbandoned();
  std::unique_ptr<FrameSeat> Join(const std::string& hello, FrameTell tell,
                                  std::string* problem) override;
  void Warn(const std::string& message) override;

 private:
  using Sessions = std::map<std::string, std::shared_ptr<PhoneSession>>;
  // All require mutex_.
  Sessions::iterator End(Sessions::iterator session);  // returns the next one
  void EndAbandonedLocked();
  bool MayEnd();  // fewer than max_sessions are being finished
  // Returns the session of this name, and whether it existed; may end another to make room.
  std::pair<std::shared_ptr<PhoneSession>, bool> Find(const std::string& name, int width,
                                                      int height, double fov);

  PhoneHostSettings settings_;
  std::mutex mutex_;
  Sessions sessions_;                                  // keys are chosen by the pages
  std::vector<std::shared_ptr<PhoneSession>> ending_;  // being finished and written
};

}  // namespace alidade
