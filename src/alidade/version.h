// Which version these headers are of. CMakeLists.txt reads its version here.
#pragma once

#define ALIDADE_VERSION_MAJOR 0
#define ALIDADE_VERSION_MINOR 2
#define ALIDADE_VERSION_PATCH 0
#define ALIDADE_VERSION "0.2.0"
