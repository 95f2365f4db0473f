// Who looks on costs the run nothing, not even when he fails.
#include "alidade/run/stream_feed.h"

#include <gtest/gtest.h>

#include <new>

#include "alidade/run/run.h"
#include "support/program.h"

namespace alidade::stream_feed_test {
namespace {

RunOptions Short(const std::string& out) {
  RunOptions options;
  options.source = "synth:room?frames=12&width=320&height=240";
  options.out = out;
  return options;
}

struct Warnings : RunWatcher {
  void Warn(const std::string& message) override { all += message + "\n"; }
  std::string all;
};

TEST(StreamFeed, ThatFailsIsWarnedOfAndTheRunIsTheSame) {
  const TempFolder folder;
  alidade::Run(Short(folder / "alone"), {});
  StreamFeed feed("test", "");
  int taken = 0;
  feed.Join([&](const std::shared_ptr<const std::string>&) {
    if (++taken == 8) throw std::bad_alloc();
  });
  Warnings warnings;
  EXPECT_EQ(alidade::Run(Short(folder / "watched"), {&warnings, &feed}).status, 0);
  EXPECT_EQ(taken, 8);
  EXPECT_NE(warnings.all.find("the stream stopped (out of memory)"), std::string::npos)
      << warnings.all;
  for (const char* file : {"/trajectory.txt", "/map.alidade"}) {
    const std::string alone = ReadText(folder / "alone" + file);
    EXPECT_FALSE(alone.empty());
    EXPECT_EQ(alone, ReadText(folder / "watched" + file)) << file;
  }
  // What was told until then can be read.
  StreamFileReader reader(folder / "watched/run.stream");
  int kept = 0;
  while (reader.Next()) ++kept;
  EXPECT_GE(kept, 7);
}

}  // namespace
}  // namespace alidade::stream_feed_test
