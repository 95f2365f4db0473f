// A table of settings: values as text, ranges in words and checked.
#include "alidade/base/settings_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/expect_error.h"

namespace alidade::settings_table_test {
namespace {

using testing::HasSubstr;

enum class Mode { kSlow, kFast };
struct Inner {
  float share = 0.3f;
};
struct Outer {
  int count = 3;
  double width = 0;
  bool on = true;
  Mode mode = Mode::kFast;
  Inner inner;

  static std::span<const Setting> Table() {
    static constexpr const char* kModes[] = {"slow", "fast", nullptr};
    static constexpr Setting kRows[] = {
        PublicSetting<&Outer::count>("outer.count", AtLeast(1), "frames", "A count."),
        PublicSetting<&Outer::width>("outer.width", ZeroOr(AtLeast(100)), "px", "A width."),
        PublicSetting<&Outer::on>("outer.on", kOnOff, "", "A switch."),
        PublicChoice<&Outer::mode>("outer.mode", kModes, "A mode."),
        ExpertSetting<&Outer::inner, &Inner::share>("outer.share", kShareBelowOne, "", "A share."),
    };
    return kRows;
  }
  void Check() const { CheckRanges(*this); }
};

TEST(SettingsTable, ValuesAreReadFromTheFieldsTheRowsName) {
  Outer outer;
  std::string all;
  for (const Setting& row : Outer::Table())
    all += FullName(row) + "=" + FormatValue(row, &outer) + " ";
  EXPECT_EQ(all, "outer.count=3 outer.width=0 outer.on=1 outer.mode=fast expert.outer.share=0.3 ");
}

TEST(SettingsTable, AValueOutsideItsRangeIsNamedWithBoth) {
  Outer outer;
  EXPECT_EQ(ComplaintAbout(outer), "");
  outer.count = 0;
  EXPECT_EQ(ComplaintAbout(outer), "setting outer.count must be at least 1, not 0");
  outer.count = 1;
  outer.width = 99;
  EXPECT_EQ(ComplaintAbout(outer), "setting outer.width must be 0 or at least 100, not 99");
  outer.width = 100;
  outer.inner.share = 1;
  EXPECT_THAT(ComplaintAbout(outer),
              HasSubstr("expert.outer.share must be at least 0 and below 1, not 1"));
  outer.inner.share = std::nanf("");
  EXPECT_THAT(ComplaintAbout(outer), HasSubstr("expert.outer.share"));
}

TEST(SettingsTable, RangesAreWritten) {
  EXPECT_EQ(RangeInWords(FromTo(1, 256)), "from 1 to 256");
  EXPECT_EQ(RangeInWords(kPositive), "above 0");
  EXPECT_EQ(RangeInWords(kPositiveShare), "above 0 and at most 1");
  EXPECT_EQ(RangeInWords({}), "");
}

}  // namespace
}  // namespace alidade::settings_table_test
