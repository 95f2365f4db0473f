#include "alidade/run/merge_outputs.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/io/files/file.h"
#include "alidade/run/output_folder.h"
#include "alidade/run/saved_map.h"

namespace alidade {
namespace {

using nlohmann::ordered_json;

constexpr int kMergeVersion = 1;  // of merge.json

size_t OriginOf(const MergedMaps& merged, KeyFrameId id) {
  for (size_t i = 0; i < merged.parts.size(); ++i) {
    if (id.value >= merged.parts[i].first_keyframe && id.value < merged.parts[i].end_keyframe)
      return i;
  }
  return merged.parts.size();
}

void MakeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) ThrowInput(path + ": cannot be made: " + error.message());
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

void CheckMergePlaces(const MergePlaces& places, const std::vector<MergeInput>& inputs) {
  std::error_code error;
  for (const MergeInput& input : inputs) {
    if (std::filesystem::equivalent(places.map, SavedMapPath(input.path), error))
      ThrowUsage("--out would replace " + places.map + ", which is one of the maps to be merged");
  }
  if (IsFile(places.folder + "/stats.json"))
    ThrowUsage("--out " + places.folder + " holds what `alidade run` left: give another folder");
}

void WriteMerge(const MergePlaces& places, const std::vector<MergeInput>& inputs,
                const MergedMaps& merged) {
  const std::vector<MergedWorld> worlds = WorldsOf(merged);
  std::map<MapId, size_t> number;  // of a world
  ordered_json world_list = ordered_json::array();
  for (const MergedWorld& world : worlds) {
    number.emplace(world.id, number.size());
    ordered_json names = ordered_json::array();
    for (size_t i : world.inputs) names.push_back(inputs[i].name);
    world_list.push_back({{"keyframes", world.keyframes},
                          {"landmarks", world.landmarks},
                          {"from", names}});
  }
  const std::string bytes = EncodeMap(merged.saved);
  MakeFolder(places.folder);
  AtomicWriteFile(places.map, bytes);
  ordered_json recordings = ordered_json::array();
  for (size_t i = 0; i < inputs.size(); ++i) {
    ordered_json files = ordered_json::array();
    const std::vector<Path> paths = MovedPaths(inputs[i], merged.parts[i], merged.saved.map);
    for (size_t k = 0; k < paths.size(); ++k) {
      const std::string file = NumberedFile(inputs[i].name, k);
      AtomicWriteFile(places.folder + "/" + file, FormatTumTrajectory(paths[k].frames));
      files.push_back({{"file", file},
                       {"world", number.at(paths[k].world)},
                       {"poses", paths[k].frames.size()},
                       {"of", paths[k].keyframes_only ? "keyframes" : "frames"}});
    }
    recordings.push_back(
        {{"name", inputs[i].name}, {"path", inputs[i].path}, {"trajectories", files}});
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
  const ordered_json all = {{"version", kMergeVersion}, {"worlds", world_list},
                            {"recordings", recordings}, {"joins", joins},
                            {"ties", merged.ties}};
  AtomicWriteFile(places.folder + "/merge.json",
                  all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace alidade
