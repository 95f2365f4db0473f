// What this processor can do. Files compiled for more than the rest of the program may include this
// header and those of C, and nothing else with inline functions: the linker could take their copy
// for other processors.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#define ALIDADE_AVX2  // files ending in _avx2.cc are compiled

namespace alidade {

bool HasAvx2();

}  // namespace alidade
#endif
