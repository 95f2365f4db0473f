// Expectations about alidade::Error: its kind and what its message must say.
#pragma once

#include <gmock/gmock.h>

#include <string>

#include "alidade/base/error.h"
#include "alidade/base/log.h"

namespace alidade {

// Runs `code`, which must throw an Error of that kind, and returns its message ("" with a failure
// otherwise).
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

// What Check() says of settings: "" when they can be.
template <typename Settings>
std::string ComplaintAbout(const Settings& settings) {
  try {
    settings.Check();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// Collects warnings while it lives, instead of printing them.
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
