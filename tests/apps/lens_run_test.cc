// A lens that bends lines, run as if it did not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/program.h"

namespace alidade::lens_run_test {
namespace {

using testing::HasSubstr;

TEST(LensRun, AStronglyBentPictureIsWarnedOfOnce) {
  const TempFolder out;
  // The rendered lens has k1 = -0.22; --fov takes it for none.
  const ProgramResult run =
      RunAlidade({"run", "synth:desk?frames=160&width=320&height=240&distortion", "--fov", "62.7",
                  "--sensor", "mono", "--out", out / "result"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("strong radial distortion"));
  EXPECT_THAT(run.err, HasSubstr("--camera"));
  const auto stats = nlohmann::json::parse(ReadText(out / "result/stats.json"));
  EXPECT_TRUE(stats["lens"]["strong"].get<bool>());
  EXPECT_NEAR(stats["lens"]["k1"].get<double>(), -0.2, 0.08);
  EXPECT_EQ(stats["warnings"].size(), 1u);
  EXPECT_THAT(ReadText(out / "result/report.html"), HasSubstr("strong radial distortion"));
}

}  // namespace
}  // namespace alidade::lens_run_test
