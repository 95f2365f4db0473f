// Warnings of the library: one line each to stderr, or to a listener if one is set.
#pragma once

#include <functional>
#include <string>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

using WarningListener = std::function<void(const std::string&)>;
// Thread-safe.

void LogWarning(const std::string& message);
// Replaces the listener; null restores stderr. The listener may be called from any thread, but
// never by two threads at once.
void SetWarningListener(WarningListener listener);

}  // namespace alidade
