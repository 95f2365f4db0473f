// What the library has to say while it runs. Warnings go to stderr, one line each, unless a
// listener takes them.
#pragma once

#include <functional>
#include <string>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

using WarningListener = std::function<void(const std::string&)>;

void LogWarning(const std::string& message);
// Replaces the listener (null: back to stderr). Called from any thread, one call at a time.
void SetWarningListener(WarningListener listener);

}  // namespace alidade
