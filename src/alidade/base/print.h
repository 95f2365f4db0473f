// std::snprintf whose decimal separator is a point whatever the program's locale: programs that
// embed the library set it (Qt and matplotlib do), and files must not depend on it.
#pragma once

#include <cstddef>

namespace alidade {

// As std::snprintf, in the C locale. Any thread.
[[gnu::format(printf, 3, 4)]] int PrintTo(char* text, size_t size, const char* format, ...);

}  // namespace alidade
