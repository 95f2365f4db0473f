// A run from the command line: its progress on the terminal, and what else shows it.
#pragma once

#include <functional>
#include <memory>

#include "alidade/run/play/watcher.h"
#include "alidade/run/setup/options.h"
#include "alidade/run/setup/stream_settings.h"
#include "alidade/stream/stream_hub.h"

namespace alidade {

// Makes another watcher of a run, which may join its stream.
using MakeWatcher =
    std::function<std::unique_ptr<RunWatcher>(StreamHub& hub, const StreamFeedSettings& settings)>;

// Returns the exit status. Throws as Run().
int RunAndTell(const RunOptions& options, const MakeWatcher& make_watcher = nullptr);

}  // namespace alidade
