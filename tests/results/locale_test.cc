// Files do not depend on the locale of the program that embeds the library.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <locale.h>

#include <cstdlib>
#include <filesystem>
#include <regex>

#include "alidade/io/files/camera_file.h"
#include "alidade/io/trajectory.h"
#include "alidade/run/run.h"
#include "support/read_text.h"
#include "support/temp_folder.h"

namespace alidade::locale_test {
namespace {

namespace fs = std::filesystem;

// Makes the program's locale one with a decimal comma while it lives.
class GermanLocale {
 public:
  GermanLocale() {
    const std::string command =
        "localedef -i de_DE -f UTF-8 --no-archive " + folder_ / "de_DE.UTF-8" + " 2>/dev/null";
    set_ = std::system(command.c_str()) == 0 && setenv("LOCPATH", folder_.path().c_str(), 1) == 0 &&
           setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
  }
  ~GermanLocale() {
    setlocale(LC_ALL, "C");
    unsetenv("LOCPATH");
  }
  bool set() const { return set_; }

 private:
  TempFolder folder_;
  bool set_ = false;
};

RunOptions Options(const std::string& out) {
  RunOptions options;
  options.source = "synth:room?frames=40&width=320&height=240&seed=3";
  options.out = out;
  options.quiet = true;
  return options;
}

TEST(Locale, ARunWritesTheSameFilesUnderADecimalComma) {
  const TempFolder folder;
  alidade::Run(Options(folder / "point"), {});
  const GermanLocale german;
  if (!german.set()) GTEST_SKIP() << "needs localedef and de_DE (Debian: locales)";
  char text[8];
  ASSERT_EQ(std::snprintf(text, sizeof(text), "%.1f", 1.5), 3);
  ASSERT_STREQ(text, "1,5") << "the locale has no effect";
  alidade::Run(Options(folder / "comma"), {});
  int compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder / "point")) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), folder / "point").string();
    const std::string with_point = ReadText(entry.path().string());
    const std::string with_comma = ReadText(folder / ("comma/" + name));
    if (name == "stats.json" || name == "report.html") {  // times differ
      static const std::regex kNumber("[0-9][.,][0-9]+");
      const auto commas = [](const std::string& words) {
        return std::count_if(std::sregex_iterator(words.begin(), words.end(), kNumber),
                             std::sregex_iterator(),
                             [](const std::smatch& match) { return match.str()[1] == ','; });
      };
      EXPECT_EQ(commas(with_comma), commas(with_point)) << name;
    } else {
      EXPECT_EQ(with_comma, with_point) << name;
    }
    ++compared;
  }
  EXPECT_GT(compared, 5);
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500.25;
  camera.cx = 319.5;
  camera.cy = 239.5;
  EXPECT_EQ(ParseCameraFile(FormatCameraFile(camera), "camera.yaml").left.fx, 500.25);
  EXPECT_EQ(ParseTumTrajectory("1.5 1 2 3 0 0 0 1\n", "poses").at(0).time, 1.5);
}

}  // namespace
}  // namespace alidade::locale_test
