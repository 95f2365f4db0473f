// Floors WITHOUT_POINTER_CASTS (cmake/AlidadeFloor.cmake) make no pointer or reference of one to
// another type. Without, nothing of theirs can lie at an odd address: the checks of alignment of
// the undefined-behavior sanitizer are left out there.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace alidade::pointer_casts_test {
namespace {

namespace fs = std::filesystem;

bool CastsAPointer(const std::string& line) {
  static const std::regex kCast(R"((reinterpret_cast|static_cast) *<[^<>]*[*&] *>|\.ptr *<)"
                                R"(|Eigen::Map *<|\((const )?[a-z0-9_:]+ ?\*\)[a-z(&])");
  return std::regex_search(line.substr(0, line.find("//")), kCast);
}

std::vector<std::string> LinesOf(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Architecture, FloorsWithoutPointerCastsHaveNone) {
  const fs::path sources = fs::path(ALIDADE_SOURCE_DIR) / "src/alidade";
  const std::regex floor(R"( *alidade_floor\((\w+) WITHOUT_POINTER_CASTS.*)");
  int floors = 0;
  std::smatch match;
  for (const std::string& text : LinesOf(sources / "CMakeLists.txt")) {
    if (!std::regex_match(text, match, floor)) continue;
    ++floors;
    for (const auto& file : fs::recursive_directory_iterator(sources / match[1].str())) {
      if (!file.is_regular_file()) continue;
      int number = 0;
      for (const std::string& line : LinesOf(file.path())) {
        ++number;
        EXPECT_FALSE(CastsAPointer(line)) << file.path() << ":" << number << ": " << line;
      }
    }
  }
  EXPECT_GE(floors, 12);
}

TEST(ArchitectureRules, SeeCastsOfPointers) {
  EXPECT_TRUE(CastsAPointer("auto* a = reinterpret_cast<const float*>(bytes);"));
  EXPECT_TRUE(CastsAPointer("auto& a = reinterpret_cast<Block&>(b);"));
  EXPECT_TRUE(CastsAPointer("*static_cast<bool*>(field) = true;"));
  EXPECT_TRUE(CastsAPointer("const auto* row = image.ptr<float>(y);"));
  EXPECT_TRUE(CastsAPointer("Eigen::Map<Eigen::Vector3d> x(numbers);"));
  EXPECT_TRUE(CastsAPointer("const int n = *(const int*)bytes;"));
  EXPECT_FALSE(CastsAPointer("return static_cast<int>(a * b);"));
  EXPECT_FALSE(CastsAPointer("return reinterpret_cast<Halves>(near);"));
  EXPECT_FALSE(CastsAPointer("int Read(const Image* image);  // reinterpret_cast<int*>"));
}

}  // namespace
}  // namespace alidade::pointer_casts_test
