// Works on the pictures that pages send (alidade phone --connected): a map for each page.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "alidade/phone/phone_slam.h"
#include "alidade/serve/frame_host.h"

namespace alidade {

class PhoneSession;

struct PhoneHostSettings {
  int max_sessions = 4;       // maps at a time: each has a thread, and some 200 MB when it is large
  double keep_seconds = 300;  // a page that lost its network goes on with its map for so long
  int max_pixels = 4'000'000;  // of a picture
  std::string out;  // folder where each session's results are written at its end; empty: none
  PhoneSettings phone = PhoneSettings::Default(true);
};

class PhoneHost : public FrameHost {
 public:
  explicit PhoneHost(PhoneHostSettings settings);
  ~PhoneHost() override;  // ends and writes all sessions
  std::unique_ptr<FrameSeat> Join(const std::string& hello, FrameTell tell,
                                  std::string* problem) override;

 private:
  PhoneHostSettings settings_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<PhoneSession>> sessions_;  // by the name the page chose
};

}  // namespace alidade
