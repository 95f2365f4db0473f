#include "alidade/io/ros/source/bag_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "alidade/base/error.h"
#include "alidade/base/module/load_module.h"
#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/text.h"

namespace alidade {
namespace {

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

bool HasBagEnding(std::string_view name) {
  constexpr std::array<std::string_view, 6> kEndings = {".bag", ".bag.active", ".mcap",
                                                        ".db3", ".mcap.zstd",  ".db3.zstd"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](std::string_view ending) { return EndsWith(name, ending); });
}

bool BeginsAsBag(const std::string& path) {
  std::array<char, 16> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  const std::string_view bytes(start.data(), start.size());
  return bytes.substr(0, 9) == "#ROSBAG V" || bytes.substr(0, 6) == "\x89MCAP0" ||
         bytes.substr(0, 15) == "SQLite format 3";
}

// "walk" for walk_0.mcap and walk_12.mcap.zstd.
std::string StemOf(const std::string& name) {
  const std::string stem = name.substr(0, name.find('.'));
  const size_t end = stem.find_last_not_of("0123456789");
  const bool numbered = end != std::string::npos && end + 1 < stem.size() && stem[end] == '_';
  return numbered ? stem.substr(0, end) : stem;
}

// Without rosbag2's metadata.yaml, files belong to one recording if their names differ only in the
// number at the end.
void CheckIsOne(const std::string& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (StemOf(name) == StemOf(names.front())) continue;
    ThrowUsage(folder + " contains several recordings: choose one of them, " + names.front() +
               " or " + name + (names.size() > 2 ? " or another" : ""));
  }
}

const LoadedFunction<BagOpenFunction>& TheBagsModule() {
  static const auto module = LoadFunction<BagOpenFunction>(kBagsModuleFile, "alidade_bags_open");
  return module;
}

std::string PathOf(const std::string& source) {
  return IsThere(source) ? source : source.substr(0, source.find('?'));
}

}  // namespace

bool IsBagRecording(const std::string& path) {
  if (IsFile(path)) return HasBagEnding(path) || BeginsAsBag(path);
  if (!IsFolder(path)) return false;
  const std::vector<std::string> names = NamesIn(path);
  return std::any_of(names.begin(), names.end(), HasBagEnding);
}

bool IsBagSource(const std::string& source) { return IsBagRecording(PathOf(source)); }

BagQuery ParseBagQuery(const std::string& source) {
  BagQuery query;
  query.path = PathOf(source);
  std::string_view rest = std::string_view(source).substr(query.path.size());
  while (!rest.empty()) {
    rest.remove_prefix(1);  // the separator ? or &
    const std::string_view option = rest.substr(0, rest.find('&'));
    rest.remove_prefix(option.size());
    const size_t equals = option.find('=');
    const std::string name(option.substr(0, equals));
    const std::string value(equals == std::string_view::npos ? "" : option.substr(equals + 1));
    if (name == "image") {
      query.image = value;
    } else if (name == "right") {
      query.right = value;
    } else if (name == "depth") {
      query.depth = value;
    } else if (name == "info") {
      query.info = value;
    } else if (name == "right_info") {
      query.right_info = value;
    } else if (name == "imu") {
      query.imu = value;
    } else if (name == "max_dt") {
      query.max_dt = ParseNumber(value);
      if (!query.max_dt || !(*query.max_dt > 0 && *query.max_dt <= 1))
        ThrowUsage("max_dt=" + value + ": must be seconds, above 0 and at most 1");
    } else {
      ThrowUsage("`" + name +
                 "` is not an option of a ROS recording; the options are image, right, depth, "
                 "info, right_info, imu (topics) and max_dt (seconds)");
    }
  }
  if (query.image && query.image->empty()) ThrowUsage("image= must name a topic");
  return query;
}

std::vector<std::string> FilesOfBag(const std::string& path) {
  if (!IsFolder(path)) return {path};
  std::vector<std::string> names = NamesIn(path);
  names.erase(std::remove_if(names.begin(), names.end(),
                             [](const std::string& name) { return !HasBagEnding(name); }),
              names.end());
  std::vector<std::string> files;
  std::sort(names.begin(), names.end(), NaturallyBefore);
  if (!IsThere(path + "/metadata.yaml")) CheckIsOne(path, names);
  // When both a file and its compressed version exist, use the uncompressed one.
  for (const std::string& name : names) {
    const bool packed = EndsWith(name, ".zstd");
    const std::string plain = packed ? name.substr(0, name.size() - 5) : name;
    if (packed && std::find(names.begin(), names.end(), plain) != names.end()) continue;
    files.push_back((std::filesystem::path(path) / name).string());
  }
  return files;
}

std::unique_ptr<BagFile> OpenBagFile(const std::string& path) {
  const auto& module = TheBagsModule();
  if (module.call == nullptr)
    ThrowInput(path + " needs " + kBagsModuleFile + ": " + module.problem);
  const std::vector<std::string> files = FilesOfBag(path);
  for (const std::string& file : files) CheckIsFile(file);
  std::string problem;
  std::unique_ptr<BagFile> bag(module.call(files, &problem));
  if (!bag) ThrowInput(problem);
  return bag;
}

}  // namespace alidade
