// `alidade evaluate depth`: semi-dense depth against the truth.
#pragma once

#include "commands.h"

namespace alidade {

void AddEvaluateDepth(CLI::App& evaluate, Action& action);

}  // namespace alidade
