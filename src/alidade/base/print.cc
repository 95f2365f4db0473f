#include "alidade/base/print.h"

#include <locale.h>

#include <cstdarg>
#include <cstdio>

namespace alidade {

int PrintTo(char* text, size_t size, const char* format, ...) {
  static const locale_t kClassic = newlocale(LC_ALL_MASK, "C", locale_t{});
  const locale_t before = uselocale(kClassic);
  va_list values;
  va_start(values, format);
  const int length = std::vsnprintf(text, size, format, values);
  va_end(values);
  uselocale(before);
  return length;
}

}  // namespace alidade
