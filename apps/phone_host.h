// Processes the images that pages send (alidade phone --connected): a map for each page.
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
  int max_sessions = 4;       // maps at a time: each has a thread, and some 200 MB when it is large
  double keep_seconds = 300;  // a page that lost its network goes on with its map for so long
  int max_pixels = 4'000'000;  // of an image
  // Folder for the results: each session gets a new folder session-N in it, at its end. Empty:
  // none.
  std::string out;
  PhoneSettings phone = PhoneSettings::Default(true);
};

class PhoneHost : public FrameHost {
 public:
  explicit PhoneHost(PhoneHostSettings settings);
  ~PhoneHost() override;  // ends and writes all sessions
  // Ends and writes the sessions whose page has been away for longer than keep_seconds.
  void EndAbandoned();
  std::unique_ptr<FrameSeat> Join(const std::string& hello, FrameTell tell,
                                  std::string* problem) override;

 private:
  using Sessions = std::vector<std::shared_ptr<PhoneSession>>;
  Sessions TakeAbandoned();  // out of sessions_; with mutex_ held
  // The session of this name, and whether it existed; may move others to `ended` to make room. With
  // mutex_ held.
  std::pair<std::shared_ptr<PhoneSession>, bool> Find(const std::string& name, int width,
                                                      int height, double fov, Sessions& ended);

  PhoneHostSettings settings_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<PhoneSession>> sessions_;  // by the name the page chose
};

}  // namespace alidade
