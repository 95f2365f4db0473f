// The library's only exception type. The message says what is wrong, where, and what to do about
// it.
#pragma once

#include <stdexcept>
#include <string>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// The value is also the program's exit status.
enum class ErrorKind {
  kUsage = 2,          // invalid flag, setting or argument
  kInput = 3,          // file or folder that cannot be read or written
  kNothingMapped = 4,  // valid input in which nothing could be tracked
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

[[noreturn]] inline void ThrowUsage(const std::string& message) {
  throw Error(ErrorKind::kUsage, message);
}
[[noreturn]] inline void ThrowInput(const std::string& message) {
  throw Error(ErrorKind::kInput, message);
}

}  // namespace alidade
