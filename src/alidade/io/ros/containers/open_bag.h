// Opens a recording in any supported container, detected by the first bytes; several files form one
// recording.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

// Throws Error (input) naming the first bad file when no file has a topic. In a recording of
// several files, a file that cannot be read is skipped with a warning.
std::unique_ptr<BagFile> OpenBag(const std::vector<std::string>& paths);

}  // namespace alidade
