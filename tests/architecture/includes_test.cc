// Includes go down only: the floors of docs/development/architecture.md, held to by reading every
// source file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::map<std::string, int> kFloors = {
    {"base", 0},     {"geometry", 1},    {"inertial", 2}, {"features", 3}, {"io", 3},
    {"detect", 3},   {"optimize", 3},    {"synth", 3},    {"place", 4},    {"evaluation", 4},
    {"map", 5},      {"tracking", 6},    {"mapping", 6},  {"looping", 6},  {"semidense", 6},
    {"dynamics", 6}, {"calibration", 7}, {"system", 8},   {"view", 9},     {"surface", 9},
    {"stream", 9},   {"ros", 9},         {"localize", 9}, {"phone", 10},   {"gles", 10},
    {"serve", 10},   {"run", 11},        {"apps", 12},    {"android", 12}, {"python", 12},
    {"bench", 12}};

// Folders inside the portable ones that are not: what touches files and heavy libraries.
const std::array<std::string, 7> kOuterFolders = {
    "base/module", "io/camera", "io/dds", "io/files", "io/media", "io/ros", "detect/onnx"};

// Not to be had in WebAssembly, or not in clang 14's libc++.
const std::array<std::string, 19> kNotPortable = {"opencv2/imgcodecs",
                                                  "opencv2/videoio",
                                                  "opencv2/dnn",
                                                  "opencv2/highgui",
                                                  "opencv2/opencv",
                                                  "yaml-cpp/",
                                                  "tbb/",
                                                  "fstream",
                                                  "filesystem",
                                                  "format",
                                                  "ranges",
                                                  "source_location",
                                                  "execution",
                                                  "stop_token",
                                                  "jpeglib",
                                                  "png.h",
                                                  "boost/",
                                                  "dds/",
                                                  "CLI/"};

// Rooms of a floor, each of which may include those before it. What is in none of them is below
// all.
const std::map<std::string, std::vector<std::string>> kRooms = {
    {"io",
     {"io/ros/containers", "io/files", "io/files/datasets", "io/ros/messages", "io/ros/source",
      "io/ros/live", "io/camera", "io/files/open_source.cc"}},
    {"run",
     {"run/sources", "run/service", "run/folder", "run/results", "run/setup", "run/calibration",
      "run/play", "run/recorder", "run/live", "run/report", "run/world", "run/export",
      "run/surface", "run/ros2", "run/georeference", "run/merge", "run/batch", "run/outputs",
      "run/run"}}};

bool StartsWith(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}

// Of a path relative to src/alidade (or apps/...): the folder that has a floor; "slam.h" is the
// façade's.
std::string FolderOf(const std::string& path) {
  const size_t slash = path.find('/');
  return slash == std::string::npos ? "system" : path.substr(0, slash);
}

// Position in kRooms of its floor, -1 for what is in none of them.
int RoomOf(const std::string& path) {
  const auto rooms = kRooms.find(FolderOf(path));
  if (rooms == kRooms.end()) return -1;
  int room = -1;
  for (size_t i = 0; i < rooms->second.size(); ++i) {
    const std::string& start = rooms->second[i];
    if (path == start || StartsWith(path, start + "/") || StartsWith(path, start + "."))
      room = static_cast<int>(i);
  }
  return room;
}

bool IsPortable(const std::string& path) {
  const std::string folder = FolderOf(path);
  if (kFloors.at(folder) > 8 && folder != "stream" && folder != "phone" && folder != "gles" &&
      folder != "ros")
    return false;
  return std::none_of(kOuterFolders.begin(), kOuterFolders.end(),
                      [&](const std::string& outer) { return StartsWith(path, outer + "/"); });
}

// Why `path` may not include `header`; nothing when it may.
std::optional<std::string> Violation(const std::string& path, const std::string& header) {
  const std::string folder = FolderOf(path);
  if (kFloors.count(folder) == 0) return "folder '" + folder + "' has no floor";
  if (IsPortable(path)) {
    for (const std::string& forbidden : kNotPortable) {
      const bool whole_name = forbidden.find('/') == std::string::npos;
      if (whole_name ? header == forbidden : StartsWith(header, forbidden)) {
        return "<" + header + "> is not portable";
      }
    }
  }
  if (!StartsWith(header, "alidade/")) return std::nullopt;
  const std::string included = header.substr(std::string("alidade/").size());
  const std::string other = FolderOf(included);
  if (kFloors.count(other) == 0) return "folder '" + other + "' has no floor";
  if (IsPortable(path) && !IsPortable(included)) return header + " is not portable";
  if (folder == other && RoomOf(path) >= 0 && RoomOf(included) > RoomOf(path))
    return header + " is a later room of " + folder;
  if (folder == other) return std::nullopt;
  const int from = kFloors.at(folder), to = kFloors.at(other);
  if (to > from)
    return header + " is upstairs (" + folder + " is on floor " + std::to_string(from) + ")";
  if (to == from) return header + " is next door (both on floor " + std::to_string(from) + ")";
  return std::nullopt;
}

std::vector<std::string> IncludesOf(const fs::path& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  std::ifstream stream(file);
  std::vector<std::string> includes;
  std::smatch match;
  for (std::string line; std::getline(stream, line);) {
    if (line.find('#') == std::string::npos) continue;
    if (std::regex_match(line, match, kInclude)) includes.push_back(match[1]);
  }
  return includes;
}

// Source files under `root`, as paths relative to `base`.
std::vector<std::string> SourcesUnder(const fs::path& root, const fs::path& base) {
  std::vector<std::string> sources;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && (extension == ".h" || extension == ".cc")) {
      sources.push_back(fs::relative(entry.path(), base).generic_string());
    }
  }
  std::sort(sources.begin(), sources.end());
  return sources;
}

TEST(Architecture, IncludesGoDownOnly) {
  const fs::path repository = ALIDADE_SOURCE_DIR;
  int includes = 0;
  const auto check = [&](const fs::path& root, const fs::path& base) {
    for (const std::string& path : SourcesUnder(root, base)) {
      for (const std::string& header : IncludesOf(base / path)) {
        ++includes;
        if (const auto why = Violation(path, header)) ADD_FAILURE() << path << ": " << *why;
      }
    }
  };
  check(repository / "src/alidade", repository / "src/alidade");
  check(repository / "apps", repository);
  check(repository / "android/jni", repository);
  check(repository / "python", repository);
  check(repository / "bench", repository);
  EXPECT_GT(includes, 100) << "the sources were not found";
}

// A room without a place in the order could include and be included by all.
TEST(Architecture, EachRoomOfRunHasItsPlace) {
  for (const auto& entry :
       fs::directory_iterator(fs::path(ALIDADE_SOURCE_DIR) / "src/alidade/run")) {
    if (entry.is_directory()) {
      EXPECT_GE(RoomOf("run/" + entry.path().filename().string() + "/x.h"), 0) << entry.path();
    }
  }
}

TEST(Architecture, EachFolderHasAFloorAndSaysWhatItIsFor) {
  for (const auto& entry : fs::directory_iterator(fs::path(ALIDADE_SOURCE_DIR) / "src/alidade")) {
    if (!entry.is_directory()) continue;
    EXPECT_EQ(kFloors.count(entry.path().filename().string()), 1u) << entry.path().filename();
    EXPECT_TRUE(fs::exists(entry.path() / "README.md")) << entry.path().filename();
  }
}

// What is installed: cmake/InstallHeaders.cmake takes the headers that mark their namespace.
bool IsInstalled(const fs::path& header) {
  const std::string name = header.filename().string();
  if (name == "slam.h" || name == "version.h" || name == "api.h") return true;
  std::ifstream stream(header);
  for (std::string line; std::getline(stream, line);) {
    if (StartsWith(line, "namespace ALIDADE_API alidade")) return true;
  }
  return false;
}

TEST(Architecture, InstalledHeadersIncludeInstalledHeadersOnly) {
  const fs::path sources = fs::path(ALIDADE_SOURCE_DIR) / "src";
  int installed = 0;
  for (const std::string& path : SourcesUnder(sources / "alidade", sources)) {
    if (fs::path(path).extension() != ".h" || !IsInstalled(sources / path)) continue;
    ++installed;
    for (const std::string& header : IncludesOf(sources / path)) {
      if (!StartsWith(header, "alidade/")) {
        EXPECT_FALSE(StartsWith(header, "yaml-cpp/") || StartsWith(header, "flatbuffers/"))
            << path << " asks users for " << header;
      } else {
        EXPECT_TRUE(IsInstalled(sources / header)) << path << " includes " << header;
      }
    }
  }
  EXPECT_GT(installed, 30);
}

// Two types of one name in one namespace are one to the linker, which takes the functions of either
// for both.
TEST(Architecture, TypesOfHeadersHaveNamesOfTheirOwn) {
  const std::regex space(R"(^namespace (?:ALIDADE_API )?(alidade\S*) \{.*)"),
      type(
          R"(^(?:struct|class|enum class) (?:ALIDADE_API )?(?:alignas\(\d+\) )?(\w+(?:::\w+)*)\b[^;]*\{$)");
  const fs::path sources = fs::path(ALIDADE_SOURCE_DIR) / "src/alidade";
  std::map<std::string, std::string> headers;  // by the type's full name
  for (const std::string& path : SourcesUnder(sources, sources)) {
    if (fs::path(path).extension() != ".h") continue;
    std::ifstream stream(sources / path);
    std::string within;
    std::smatch match;
    for (std::string line; std::getline(stream, line);) {
      if (std::regex_match(line, match, space)) within = match[1];
      if (!std::regex_match(line, match, type)) continue;
      const auto [other, fresh] = headers.emplace(within + "::" + match[1].str(), path);
      EXPECT_TRUE(fresh) << other->first << " is in " << other->second << " and in " << path;
    }
  }
  EXPECT_GT(headers.size(), 300u) << "the types were not found";
}

TEST(ArchitectureRules, SeeIncludesThatGoUpOrSideways) {
  EXPECT_FALSE(Violation("map/keyframe.h", "alidade/features/frame.h"));
  EXPECT_FALSE(Violation("map/keyframe.h", "alidade/map/landmark.h"));
  EXPECT_FALSE(Violation("evaluation/ate.h", "alidade/io/trajectory.h"));
  EXPECT_FALSE(Violation("apps/main.cc", "alidade/io/files/dataset.h"));
  EXPECT_FALSE(Violation("slam.h", "alidade/system/slam.h"));
  EXPECT_TRUE(Violation("features/frame.h", "alidade/map/keyframe.h"));    // up
  EXPECT_TRUE(Violation("tracking/track.h", "alidade/mapping/mapper.h"));  // sideways
  EXPECT_TRUE(Violation("optimize/pose.h", "alidade/features/frame.h"));   // sideways
  EXPECT_TRUE(Violation("tracking/track.h", "alidade/slam.h"));            // up
  EXPECT_TRUE(Violation("cellar/wine.h", "alidade/base/error.h"));         // nowhere
  EXPECT_FALSE(Violation("io/ros/source/bag_source.cc", "alidade/io/ros/messages/messages.h"));
  EXPECT_TRUE(Violation("io/ros/messages/messages.h", "alidade/io/ros/source/bag_player.h"));
  EXPECT_TRUE(Violation("io/files/file.cc", "alidade/io/ros/source/bag_source.h"));
  EXPECT_TRUE(Violation("io/files/file.cc", "alidade/io/files/datasets/recording.h"));
  EXPECT_FALSE(Violation("io/files/open_source.cc", "alidade/io/ros/source/bag_source.h"));
  EXPECT_FALSE(Violation("run/play/loop.h", "alidade/run/setup/options.h"));
  EXPECT_FALSE(Violation("run/run.h", "alidade/run/outputs.h"));
  EXPECT_TRUE(Violation("run/results/run_log.h", "alidade/run/calibration/find_camera.h"));
  EXPECT_TRUE(Violation("run/batch/batch_list.cc", "alidade/run/run.h"));
}

TEST(ArchitectureRules, SeeWhatIsNotPortable) {
  EXPECT_TRUE(Violation("features/frame.h", "opencv2/imgcodecs.hpp"));
  EXPECT_TRUE(Violation("io/trajectory.cc", "fstream"));
  EXPECT_TRUE(Violation("evaluation/ate.cc", "alidade/io/files/file.h"));
  EXPECT_TRUE(Violation("system/slam.cc", "yaml-cpp/yaml.h"));
  EXPECT_FALSE(Violation("io/files/image_file.cc", "fstream"));
  EXPECT_FALSE(Violation("features/frame.h", "opencv2/core.hpp"));
  EXPECT_FALSE(Violation("base/log.cc", "formatter.h"));
}

}  // namespace
