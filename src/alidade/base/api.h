// Marks the public API. Headers that open `namespace ALIDADE_API alidade` are installed and their
// declarations are exported from the shared library; all other symbols are hidden.
#pragma once

#define ALIDADE_API [[gnu::visibility("default")]]
