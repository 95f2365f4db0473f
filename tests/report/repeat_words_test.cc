// The options that the report's next command repeats.
#include <gtest/gtest.h>

#include "alidade/run/setup/options.h"

namespace alidade::repeat_words_test {
namespace {

TEST(RepeatWords, AreThoseThatDecideTheResult) {
  EXPECT_EQ(RepeatWords({}), "");
  RunOptions options;
  options.profile = "phone";
  options.config = "my settings.yaml";
  options.settings = {"tracker.min_found=20", "loop.enabled=0"};
  options.last = 99;
  options.seed = 3;
  options.threads = 2;
  options.quiet = options.overwrite = true;
  EXPECT_EQ(RepeatWords(options),
            " --profile phone --config 'my settings.yaml' --set tracker.min_found=20 --set "
            "loop.enabled=0 --seed 3 --last 99");
}

}  // namespace
}  // namespace alidade::repeat_words_test
