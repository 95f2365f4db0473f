// `alidade-bench lasting`: hours in one place; only with scripts/test --long.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/bench_result.h"
#include "support/rendered.h"

namespace alidade::bench_lasting_test {
namespace {

TEST(LongRecording, HoursInOnePlaceCostNoMemory) {
  if (std::getenv("ALIDADE_LONG_TESTS") == nullptr) GTEST_SKIP() << "only with scripts/test --long";
  const std::string room = Rendered({"room", "--frames", "300"});
  const nlohmann::json bench = BenchResult({"lasting", room, "--sensor", "mono"});
  const auto value = [&](const std::string& when, const std::string& metric) {
    return ValueOf(bench, {"room_--frames_300, " + when, metric, "mono"});
  };
  const double middle = value("10000 frames", "resident_memory");
  ASSERT_GT(middle, 0);
  // The trajectory's own: 128 bytes a frame.
  EXPECT_LE(value("20000 frames", "resident_memory"), 1.1 * middle + 10000 * 128e-6);
  EXPECT_EQ(value("at the end", "localized"), 100);
}

}  // namespace
}  // namespace alidade::bench_lasting_test
