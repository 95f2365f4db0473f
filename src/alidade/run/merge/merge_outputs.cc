#include "alidade/run/merge/merge_outputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/folder/output_folder.h"
#include "alidade/run/sources/saved_map.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

constexpr int kMergeVersion = 1;  // version of merge.json

size_t OriginOf(const MergedMaps& merged, KeyFrameId id) {
  for (size_t i = 0; i < merged.parts.size(); ++i) {
    if (id.value >= merged.parts[i].first_keyframe && id.value < merged.parts[i].end_keyframe)
      return i;
  }
  return merged.parts.size();
}

// The absolute path of a map, independent of how it was typed.
std::string PlaceOfMap(const std::string& path) {
  std::error_code error;
  const auto place = std::filesystem::weakly_canonical(SavedMapPath(path), error);
  return error ? path : place.string();
}

// The files of an earlier merge in a folder, from its merge.json.
struct EarlierMerge {
  std::set<std::string> inputs, files;
};

EarlierMerge ReadEarlierMerge(const std::string& folder) {
  EarlierMerge earlier;
  const std::string file = folder + "/merge.json";
  if (!IsFile(file)) return earlier;
  const auto told = ordered_json::parse(ReadFile(file), nullptr, /*allow_exceptions=*/false);
  // The file may have been written by anybody.
  const auto list_in = [](const ordered_json& object, const char* name) {
    const bool there = object.is_object() && object.contains(name) && object[name].is_array();
    return there ? object[name] : ordered_json::array();
  };
  const auto word_in = [](const ordered_json& object, const char* name) {
    const bool there = object.is_object() && object.contains(name) && object[name].is_string();
    return there ? object[name].get<std::string>() : std::string();
  };
  for (const ordered_json& recording : list_in(told, "recordings")) {
    const std::string place = word_in(recording, "place");
    earlier.inputs.insert(place.empty() ? PlaceOfMap(word_in(recording, "path")) : place);
    for (const ordered_json& trajectory : list_in(recording, "trajectories")) {
      const std::string name = word_in(trajectory, "file");
      if (name.ends_with(".txt") && name.find('/') == std::string::npos) earlier.files.insert(name);
    }
  }
  return earlier;
}

void MakeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) ThrowInput(path + ": cannot be created: " + error.message());
}

}  // namespace

std::vector<MergedWorld> WorldsOf(const MergedMaps& merged) {
  std::vector<MergedWorld> worlds;
  for (const MapPart& part : PartsOf(merged.saved.map)) {
    MergedWorld world;
    world.id = merged.saved.map.MapOf(part.keyframes.front());
    world.keyframes = static_cast<int>(part.keyframes.size());
    world.landmarks = static_cast<int>(part.landmarks.size());
    for (KeyFrameId id : part.keyframes) {
      const size_t input = OriginOf(merged, id);
      if (std::count(world.inputs.begin(), world.inputs.end(), input) == 0)
        world.inputs.push_back(input);
    }
    std::sort(world.inputs.begin(), world.inputs.end());
    worlds.push_back(std::move(world));
  }
  return worlds;
}

MergePlaces MergePlacesOf(const std::string& out) {
  const std::filesystem::path path(out);
  if (path.extension() == ".alidade") {
    std::filesystem::path folder = path;
    return {out, folder.replace_extension(".trajectories").string()};
  }
  return {(path / "map.alidade").string(), out};
}

void CheckMergePlaces(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                      bool overwrite) {
  std::error_code error;
  for (const MergeInput& input : inputs) {
    if (std::filesystem::equivalent(places.map, SavedMapPath(input.path), error))
      ThrowUsage("--out would replace " + places.map + ", which is one of the maps to merge");
  }
  if (IsFile(places.folder + "/stats.json"))
    ThrowUsage("--out " + places.folder +
               " contains results of `alidade run`: choose another folder");
  if (overwrite) return;
  const EarlierMerge earlier = ReadEarlierMerge(places.folder);
  std::set<std::string> now;
  for (const MergeInput& input : inputs) now.insert(PlaceOfMap(input.path));
  const bool of_these =
      std::includes(now.begin(), now.end(), earlier.inputs.begin(), earlier.inputs.end());
  if (IsThere(places.map) && (earlier.inputs.empty() || !of_these)) {
    ThrowUsage("--out would replace " + places.map +
               ", which was not made from these maps: choose another file, or use --overwrite");
  }
  for (const MergeInput& input : inputs) {
    const std::string name = NumberedFile(input.name, 0);
    if (IsThere(places.folder + "/" + name) && earlier.files.count(name) == 0) {
      ThrowUsage("--out would replace " + places.folder + "/" + name +
                 ", which is not from an earlier merge: choose another file, or use --overwrite");
    }
  }
}

void WriteMerge(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                const MergedMaps& merged) {
  const std::vector<MergedWorld> worlds = WorldsOf(merged);
  std::map<MapId, size_t> number;  // of each world
  ordered_json world_list = ordered_json::array();
  for (const MergedWorld& world : worlds) {
    number.emplace(world.id, number.size());
    ordered_json names = ordered_json::array();
    for (size_t i : world.inputs) names.push_back(inputs[i].name);
    world_list.push_back(
        {{"keyframes", world.keyframes}, {"landmarks", world.landmarks}, {"from", names}});
  }
  const std::string bytes = EncodeMap(merged.saved);
  std::set<std::string> left_over = ReadEarlierMerge(places.folder).files;
  MakeFolder(places.folder);
  AtomicWriteFile(places.map, bytes);
  ordered_json recordings = ordered_json::array();
  for (size_t i = 0; i < inputs.size(); ++i) {
    ordered_json files = ordered_json::array();
    const std::vector<Path> paths = MovedPaths(inputs[i], merged.parts[i], merged.saved.map);
    for (size_t k = 0; k < paths.size(); ++k) {
      const std::string file = NumberedFile(inputs[i].name, k);
      AtomicWriteFile(places.folder + "/" + file, FormatTumTrajectory(paths[k].frames));
      left_over.erase(file);
      files.push_back({{"file", file},
                       {"world", number.at(paths[k].world)},
                       {"poses", paths[k].frames.size()},
                       {"of", paths[k].keyframes_only ? "keyframes" : "frames"}});
    }
    recordings.push_back({{"name", inputs[i].name},
                          {"path", inputs[i].path},
                          {"place", PlaceOfMap(inputs[i].path)},
                          {"trajectories", files}});
  }
  ordered_json joins = ordered_json::array();
  for (const MapJoin& join : merged.joins) {
    const auto side = [&](KeyFrameId id) -> ordered_json {
      return {{"recording", inputs[OriginOf(merged, id)].name},
              {"time", merged.saved.map.Find(id)->frame->time}};
    };
    joins.push_back({{"keyframe", side(join.keyframe)},
                     {"place", side(join.place)},
                     {"found", join.found},
                     {"visible", join.visible}});
  }
  const ordered_json all = {{"version", kMergeVersion}, {"sensor", merged.saved.sensor},
                            {"worlds", world_list},     {"recordings", recordings},
                            {"joins", joins},           {"ties", merged.ties}};
  AtomicWriteFile(places.folder + "/merge.json",
                  all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  std::error_code ignored;
  for (const std::string& file : left_over)
    std::filesystem::remove(places.folder + "/" + file, ignored);
}

}  // namespace alidade
