// `alidade evaluate depth`: compares semi-dense depth with ground truth.
#pragma once

#include "commands.h"

namespace alidade {

void AddEvaluateDepth(CLI::App& evaluate, Action& action);

}  // namespace alidade
