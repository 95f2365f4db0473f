#include "alidade/run/results/frame_stamps.h"

#include <gtest/gtest.h>

#include "alidade/io/files/spill_file.h"
#include "support/temp_folder.h"

namespace alidade::frame_stamps_test {
namespace {

std::string StampOf(int i) { return i % 7 == 0 ? "" : std::to_string(1305031102 + i) + ".17"; }

TEST(FrameStamps, AreTheSameInMemoryAndInAFile) {
  const TempFolder folder;
  FrameStamps memory, file;
  file.KeepIn(MakeSpillFile(folder.path()));
  for (FrameStamps* stamps : {&memory, &file}) {
    EXPECT_TRUE(stamps->empty());
    for (int i = 0; i < 2000; ++i) {
      stamps->Add({StampOf(i), 3 * i + 5});
      if (i % 512 == 0) {  // a frame that is refused
        stamps->Add({"refused", 0});
        stamps->TakeBack();
      }
    }
    ASSERT_EQ(stamps->size(), 2000u);
    EXPECT_EQ(stamps->first_number(), 5);
    FrameStamps::Reader reader(*stamps);
    for (int i : {0, 1, 511, 512, 700, 1999, 1536, 3, 1535}) {
      EXPECT_EQ(reader.At(static_cast<size_t>(i)).stamp, StampOf(i)) << i;
      EXPECT_EQ(reader.At(static_cast<size_t>(i)).number, 3 * i + 5) << i;
    }
  }
}

}  // namespace
}  // namespace alidade::frame_stamps_test
