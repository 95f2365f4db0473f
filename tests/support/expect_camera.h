// Compares cameras of calibration files.
#pragma once

#include <gtest/gtest.h>

#include "alidade/geometry/raw_camera.h"

namespace alidade {

inline void ExpectCamera(const RawCamera& read, const RawCamera& wanted) {
  EXPECT_EQ(read.lens, wanted.lens);
  EXPECT_EQ(read.width, wanted.width);
  EXPECT_EQ(read.height, wanted.height);
  EXPECT_NEAR(read.fx, wanted.fx, 1e-9);
  EXPECT_NEAR(read.fy, wanted.fy, 1e-9);
  EXPECT_NEAR(read.cx, wanted.cx, 1e-9);
  EXPECT_NEAR(read.cy, wanted.cy, 1e-9);
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(read.distortion[i], wanted.distortion[i], 1e-9);
}

}  // namespace alidade
