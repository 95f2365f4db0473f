// The library's one include.
#pragma once

#include "alidade/system/slam.h"
#include "alidade/version.h"
