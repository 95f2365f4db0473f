#include <gtest/gtest.h>

#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/open_source.h"
#include "support/expect_error.h"
#include "support/tiny_recording.h"

namespace alidade::folder_source_test {
namespace {

TEST(FolderSource, SortsNamesAsPeopleCount) {
  EXPECT_TRUE(NaturallyBefore("img2.png", "img10.png"));
  EXPECT_FALSE(NaturallyBefore("img10.png", "img2.png"));
  EXPECT_TRUE(NaturallyBefore("img009.png", "img10.png"));
  EXPECT_TRUE(NaturallyBefore("a.png", "b.png"));
  EXPECT_TRUE(NaturallyBefore("7", "07") != NaturallyBefore("07", "7"));
  EXPECT_FALSE(NaturallyBefore("same", "same"));
  EXPECT_TRUE(NaturallyBefore("99999999999999999999998", "99999999999999999999999"));
}

TEST(FolderSource, TimesAreThoseOfTheFrameRate) {
  const TempFolder folder;
  for (const int i : {1, 2, 10})
    WriteImage(folder / ("f" + std::to_string(i) + ".png"), TinyImage(i));
  folder.Write("notes.txt", "not an image");
  folder.Write("camera.yaml",
               "model: pinhole\nwidth: 64\nheight: 48\nfx: 60\nfy: 61\ncx: 31\ncy: 24\nfps: 20\n");
  const auto source = OpenSource(folder.path());
  EXPECT_EQ(source->Info().kind, "images");
  EXPECT_EQ(source->Info().frames, 3);
  EXPECT_EQ(source->Next()->stamp, "0.000000000");
  EXPECT_DOUBLE_EQ(source->Next()->time, 0.05);
  EXPECT_EQ(cv::norm(source->Next()->image, TinyImage(10), cv::NORM_INF), 0);
}

TEST(FolderSource, OfFilesThatAreNoImagesIsAnError) {
  const TempFolder folder;
  folder.Write("a.png", "");
  folder.Write("b.png", "x");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder.path()); }),
              testing::HasSubstr("no image can be read"));
}

}  // namespace
}  // namespace alidade::folder_source_test
