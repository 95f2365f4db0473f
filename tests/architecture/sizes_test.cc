// No folder of more than 40 source files, no source file of more than 400 lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "support/temp_folder.h"

namespace alidade::sizes_test {
namespace {

namespace fs = std::filesystem;

constexpr int kMostFiles = 40, kMostLines = 400;
const std::array<std::string, 4> kCountedFolders = {"src", "apps", "tests", "bench"};
const std::array<std::string, 10> kReadFolders = {"src", "apps", "tests",   "bench",    "python",
                                                  "web", "wasm", "android", "examples", "scripts"};
const std::array<std::string, 10> kLanguages = {".cc", ".h",  ".cpp", ".ts",   ".tsx",
                                                ".js", ".py", ".kt",  ".java", ".mjs"};
// Not written by hand, or not ours: builds, packages of npm, what is made from schemas.
const std::array<std::string, 4> kNotOurs = {"node_modules", "generated", "dist", "build"};

bool IsCpp(const fs::path& file) { return file.extension() == ".cc" || file.extension() == ".h"; }

int LinesOf(const fs::path& file) {
  std::ifstream stream(file);
  int lines = 0;
  for (std::string line; std::getline(stream, line);) ++lines;
  return lines;
}

// Programs without an extension name their language in the first line.
bool IsSource(const fs::path& file) {
  const std::string extension = file.extension().string();
  if (!extension.empty())
    return std::find(kLanguages.begin(), kLanguages.end(), extension) != kLanguages.end();
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line.compare(0, 2, "#!") == 0 && line.find("python") != std::string::npos;
}

// What is too large under `root`, a sentence each.
std::vector<std::string> TooLarge(const fs::path& root) {
  std::vector<std::string> problems;
  std::map<std::string, int> files;  // by folder
  for (const std::string& top : kReadFolders) {
    if (!fs::exists(root / top)) continue;
    const bool counted =
        std::find(kCountedFolders.begin(), kCountedFolders.end(), top) != kCountedFolders.end();
    for (auto entry = fs::recursive_directory_iterator(root / top);
         entry != fs::recursive_directory_iterator(); ++entry) {
      const fs::path path = entry->path();
      if (entry->is_directory() && (path.filename().string().front() == '.' ||
                                    std::find(kNotOurs.begin(), kNotOurs.end(),
                                              path.filename().string()) != kNotOurs.end())) {
        entry.disable_recursion_pending();
        continue;
      }
      if (!entry->is_regular_file() || !IsSource(path)) continue;
      const std::string name = fs::relative(path, root).generic_string();
      if (counted && IsCpp(path)) ++files[fs::path(name).parent_path().generic_string()];
      const int lines = LinesOf(path);
      if (lines > kMostLines) problems.push_back(name + " has " + std::to_string(lines) + " lines");
    }
  }
  for (const auto& [folder, count] : files) {
    if (count > kMostFiles)
      problems.push_back(folder + " has " + std::to_string(count) + " source files");
  }
  return problems;
}

TEST(Sizes, FoldersAndFilesAreSmall) {
  for (const std::string& problem : TooLarge(ALIDADE_SOURCE_DIR)) ADD_FAILURE() << problem;
}

void Write(const fs::path& file, int lines) {
  fs::create_directories(file.parent_path());
  std::ofstream stream(file);
  for (int i = 0; i < lines; ++i) stream << "x\n";
}

TEST(SizesRules, SeeFilesAndFoldersThatAreTooLarge) {
  const TempFolder folder;
  const fs::path root = folder.path();
  Write(root / "src/a/long.cc", kMostLines + 1);
  Write(root / "web/page.ts", kMostLines + 1);
  Write(root / "web/whole.ts", kMostLines);
  Write(root / "web/generated/made.ts", kMostLines + 1);
  Write(root / "src/a/README.md", kMostLines + 1);
  for (int i = 0; i <= kMostFiles; ++i) Write(root / "tests/b" / (std::to_string(i) + ".cc"), 1);
  for (int i = 0; i < kMostFiles; ++i) Write(root / "tests/c" / (std::to_string(i) + ".cc"), 1);
  EXPECT_EQ(TooLarge(root),
            (std::vector<std::string>{"src/a/long.cc has 401 lines", "web/page.ts has 401 lines",
                                      "tests/b has 41 source files"}));
}

}  // namespace
}  // namespace alidade::sizes_test
