// Checks an alidade::Error's kind and message.
#pragma once

#include <gmock/gmock.h>

#include <string>

#include "alidade/base/error.h"
#include "alidade/base/log.h"

namespace alidade {

// Runs `code`, which must throw an Error of this kind, and returns its message (otherwise a test
// failure and "").
template <typename Code>
std::string MessageOf(ErrorKind kind, const Code& code) {
  try {
    code();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no Error was thrown";
  return "";
}

// The message of settings' Check(); "" for valid settings.
template <typename Settings>
std::string ComplaintAbout(const Settings& settings) {
  try {
    settings.Check();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Collects warnings during its lifetime instead of printing them.
class WarningCatcher {
 public:
  WarningCatcher() {
    SetWarningListener([this](const std::string& message) { text_ += message + "\n"; });
  }
  ~WarningCatcher() { SetWarningListener(nullptr); }
  WarningCatcher(const WarningCatcher&) = delete;
  WarningCatcher& operator=(const WarningCatcher&) = delete;
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace alidade
