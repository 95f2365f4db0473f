// Any of the containers, by what a file begins with; several files as one recording.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "alidade/io/ros/containers/bags_module.h"

namespace alidade {

// Throws Error (input), naming the file, when there is nothing to be read in any of them. One of
// several that cannot be read costs its own messages, and a warning.
std::unique_ptr<BagFile> OpenBag(const std::vector<std::string>& paths);

}  // namespace alidade
