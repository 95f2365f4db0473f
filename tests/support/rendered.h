// Rendered recordings for end-to-end tests, made by the program, each once per test run.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "support/program.h"

namespace alidade {

// Folder of the recording that `alidade synth` makes from `arguments` ({"room", "--frames", "30"}).
// CTest empties the folder of recordings before the first test. The content must not be modified
// (use CopyOf()).
inline std::string Rendered(const std::vector<std::string>& arguments) {
  namespace fs = std::filesystem;
  std::string name;
  for (const std::string& argument : arguments) name += (name.empty() ? "" : "_") + argument;
  const fs::path folder = fs::path(ALIDADE_TEST_RECORDINGS) / name;
  if (fs::exists(folder)) return folder.string();
  const fs::path draft = folder.string() + "." + std::to_string(getpid());
  fs::create_directories(draft.parent_path());
  std::vector<std::string> words = {"synth", arguments.front(), draft.string()};
  words.insert(words.end(), arguments.begin() + 1, arguments.end());
  const ProgramResult result = RunAlidade(words);
  EXPECT_EQ(result.status, 0) << result.err;
  std::error_code taken;  // another test process made the same recording
  fs::rename(draft, folder, taken);
  if (taken) fs::remove_all(draft);
  return folder.string();
}

// A copy that may be modified.
inline std::string CopyOf(const std::string& recording, const TempFolder& folder) {
  namespace fs = std::filesystem;
  const std::string copy = folder / "recording";
  fs::copy(recording, copy, fs::copy_options::recursive);
  return copy;
}

// Lines of a text file, without line ends.
inline std::vector<std::string> ReadLines(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

// The lines that are not comments.
inline std::vector<std::string> DataLines(const std::string& path) {
  std::vector<std::string> lines;
  for (std::string& line : ReadLines(path)) {
    if (!line.empty() && line[0] != '#') lines.push_back(std::move(line));
  }
  return lines;
}

inline void WriteLines(const std::string& path, const std::vector<std::string>& lines) {
  std::ofstream file(path, std::ios::trunc);
  for (const std::string& line : lines) file << line << '\n';
}

}  // namespace alidade
