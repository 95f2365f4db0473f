#include "alidade/base/log.h"

#include <cstdio>
#include <mutex>

namespace alidade {
namespace {
std::mutex g_mutex;
WarningListener g_listener;
}  // namespace

void LogWarning(const std::string& message) {
  std::lock_guard<std::mutex> lock(g_mutex);
  if (g_listener) {
    g_listener(message);
  } else {
    std::fprintf(stderr, "warning: %s\n", message.c_str());
  }
}

void SetWarningListener(WarningListener listener) {
  std::lock_guard<std::mutex> lock(g_mutex);
  g_listener = std::move(listener);
}

}  // namespace alidade
