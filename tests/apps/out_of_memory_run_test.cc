// No memory for a worker, somewhere in a run of the program: the results are written all the same,
// one line says what stopped, and the status is 70.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "alidade/map/map_file.h"
#include "support/rendered.h"

namespace alidade::out_of_memory_run_test {
namespace {

TEST(OutOfMemory, CostsAStageAndNoResults) {
  const std::string recording =
      Rendered({"room", "--frames", "40", "--width", "320", "--height", "240"});
  const TempFolder folder;
  int stopped = 0;
  // Where in the run that is depends on the threads; somewhere among these it is a worker's.
  for (const char* number : {"3000", "9000", "20000", "40000", "60000", "80000"}) {
    const std::string out = folder / number;
    setenv("LD_PRELOAD", ALIDADE_FAIL_ALLOCATION, 1);
    setenv("ALIDADE_FAIL_ALLOCATION", number, 1);
    const ProgramResult run =
        RunAlidade({"run", recording, "--sensor", "rgbd", "--schedule", "threaded", "--rate", "max",
                    "--threads", "1", "--out", out});
    unsetenv("LD_PRELOAD");
    unsetenv("ALIDADE_FAIL_ALLOCATION");
    ASSERT_TRUE(run.status == 0 || run.status == 70) << number << ": " << run.status << run.err;
    ASSERT_TRUE(std::filesystem::exists(out + "/map.alidade")) << run.err;
    DecodeMap(ReadText(out + "/map.alidade"));
    const auto stats = nlohmann::json::parse(ReadText(out + "/stats.json"));
    if (run.status == 0) {
      EXPECT_EQ(stats["frames"], 40);
      continue;
    }
    EXPECT_NE(run.err.find("out of memory"), std::string::npos) << run.err;
    if (stats["frames"] < 40) continue;  // the memory was the reader's: the recording ends there
    ++stopped;
    EXPECT_FALSE(stats["stopped"].empty());
    EXPECT_NE(run.err.find("stopped"), std::string::npos) << run.err;
    EXPECT_NE(run.err.find(out), std::string::npos) << run.err;
  }
  EXPECT_GT(stopped, 0);
}

}  // namespace
}  // namespace alidade::out_of_memory_run_test
