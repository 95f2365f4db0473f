// What was measured, as lines of a terminal.
#pragma once

#include "bench/measure/result.h"

namespace alidade::bench {

void PrintSection(const Section& section);

}  // namespace alidade::bench
