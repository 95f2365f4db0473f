// What users of the library may rely on: headers that say `namespace ALIDADE_API alidade` are
// installed, and what they declare is visible in the shared library; everything else is hidden.
#pragma once

#define ALIDADE_API [[gnu::visibility("default")]]
