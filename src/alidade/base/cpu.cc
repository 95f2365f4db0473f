#include "alidade/base/cpu.h"

#ifdef ALIDADE_AVX2
namespace alidade {

bool HasAvx2() {
  static const bool has = __builtin_cpu_supports("avx2");
  return has;
}

}  // namespace alidade
#endif
