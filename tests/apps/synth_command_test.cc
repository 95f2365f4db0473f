// `alidade synth`: what it writes is a recording.
#include <gtest/gtest.h>

#include <string>

#include "support/program.h"

namespace alidade::synth_command_test {
namespace {

TEST(SynthCommand, WhatTheCommandWritesIsRenderedAgainForItsDepth) {
  const TempFolder folder;
  const std::string made = folder / "made", out = folder / "out";
  const ProgramResult written = RunAlidade(
      {"synth", "desk", made, "--frames", "3", "--path", "still", "--things", "1", "--width", "320",
       "--height", "240", "--blur=35", "--rolling-shutter", "10", "--light", "0.5"});
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_NE(ReadText(made + "/synth.json").find("\"path\": \"still\""), std::string::npos);
  // Depth of a recording is compared with itself, rendered anew.
  const ProgramResult run = RunAlidade({"run", made, "--semidense", "--out", out});
  ASSERT_EQ(run.status, 0) << run.err;
  const ProgramResult depth = RunAlidade({"evaluate", "depth", made, out});
  EXPECT_EQ(depth.status, 0) << depth.err;
}

}  // namespace
}  // namespace alidade::synth_command_test
