#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/map/map_checksum.h"
#include "alidade/map/map_decode_parts.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_generated.h"

namespace alidade {
namespace {

// Decoded objects by id, before they are put into a table.
template <typename Object>
class Objects {
 public:
  // Creates an object; throws Error with `complaint` if the id already exists.
  Object& Add(uint32_t id, uint32_t next, const char* complaint) {
    Require(id < next, "an id was never assigned");
    const auto [place, is_new] = by_id_.try_emplace(id);
    Require(is_new, complaint);
    place->second = std::make_shared<Object>();
    place->second->id = {id};
    return *place->second;
  }
  Object* Find(uint32_t id) const {
    const auto it = by_id_.find(id);
    return it == by_id_.end() ? nullptr : it->second.get();
  }
  IdTable<Object> Table() const {
    IdTable<Object> table;
    for (const auto& [id, object] : by_id_) table.Set(id, object, /*version=*/0);
    return table;
  }
  const auto& by_id() const { return by_id_; }

 private:
  std::map<uint32_t, std::shared_ptr<Object>> by_id_;
};

class Decoder {
 public:
  Decoder(const fb::Map& file, size_t file_size)
      : file_(file), budget_(file_size), camera_(DecodeCamera(*file.camera())) {
    // Every keyframe gets a grid over the image plus margin, with a few bytes per cell. Limits the
    // total size of the grids relative to the file size.
    constexpr size_t kSlack = 1 << 24, kCellsPerByte = 16, kMargins = 512;  // pixels
    const size_t area = (static_cast<size_t>(camera_.width) + kMargins) *
                        (static_cast<size_t>(camera_.height) + kMargins);
    const size_t cells = area / (size_t{KeypointGrid::kCell} * KeypointGrid::kCell) + 1;
    Require(SizeOf(file.keyframes()) <= (kCellsPerByte * file_size + kSlack) / cells,
            "its image is too large for so many keyframes");
  }

  SavedMap Run() {
    for (uint32_t i = 0; i < SizeOf(file_.keyframes()); ++i) {
      ReadKeyFrame(*file_.keyframes()->Get(i));
    }
    CheckTree();
    for (uint32_t i = 0; i < SizeOf(file_.keyframes()); ++i) {
      CheckTies(*keyframes_.Find(file_.keyframes()->Get(i)->id()));
    }
    for (uint32_t i = 0; i < SizeOf(file_.landmarks()); ++i) {
      ReadLandmark(*file_.landmarks()->Get(i));
    }

    SavedMap saved;
    saved.version = file_.version();
    saved.camera = camera_;
    saved.sensor = file_.sensor()->str();
    Require(saved.sensor == "mono" || saved.sensor == "stereo" || saved.sensor == "rgbd",
            "its sensor is unknown");
    for (uint32_t i = 0; i < SizeOf(file_.settings()); ++i) {
      const fb::Setting& setting = *file_.settings()->Get(i);
      budget_.Take(setting.name()->size() + setting.value()->size(), 1);
      saved.settings.push_back({setting.name()->str(), setting.value()->str()});
    }
    saved.places = DecodePlaces(file_.places(), budget_);
    Require(saved.places.grown_at <= file_.next_keyframe(),
            "its vocabulary was built from keyframes that never existed");
    auto state = std::make_shared<MapState>();
    state->keyframes = keyframes_.Table();
    state->landmarks = landmarks_.Table();
    state->next_keyframe = file_.next_keyframe();
    state->next_landmark = file_.next_landmark();
    state->next_map = NextMap();
    ReadWorlds(*state);
    saved.map = MapSnapshot(std::move(state));
    return saved;
  }

 private:
  // Files of version 1 contain one map.
  uint32_t NextMap() const {
    return file_.version() == 1 ? (file_.next_keyframe() > 0) : file_.next_map();
  }

  void ReadKeyFrame(const fb::KeyFrame& from) {
    KeyFrame& keyframe =
        keyframes_.Add(from.id(), file_.next_keyframe(), "two keyframes have one id");
    keyframe.frame = DecodeFrame(from, camera_, budget_);
    keyframe.T_camera_world = DecodePose(from.t_camera_world());
    keyframe.map = {from.map()};
    Require(from.map() < NextMap(), "a keyframe is in a map that never existed");
    keyframe.parent = {from.parent()};
    keyframe.scale = DecodeScale(from.scale());
    keyframe.landmarks.resize(keyframe.frame->keypoints.size());
    budget_.Take(SizeOf(from.covisible()), sizeof(fb::Neighbour));
    for (uint32_t n = 0; n < SizeOf(from.covisible()); ++n) {
      const fb::Neighbour& neighbour = *from.covisible()->Get(n);
      keyframe.covisible.push_back({{neighbour.keyframe()}, static_cast<int>(neighbour.shared())});
    }
    budget_.Take(SizeOf(from.loops()), sizeof(uint32_t));
    for (uint32_t n = 0; n < SizeOf(from.loops()); ++n) {
      const KeyFrameId other{from.loops()->Get(n)};
      Require(keyframe.loops.empty() || keyframe.loops.back() < other, "loops are out of order");
      keyframe.loops.push_back(other);
    }
  }

  // Requires parents to precede their children (which excludes cycles) and one tree per map.
  void CheckTree() {
    std::set<MapId> rooted;
    for (const auto& [id, keyframe] : keyframes_.by_id()) {
      if (!keyframe->parent.valid()) {
        Require(rooted.insert(keyframe->map).second, "a map has two first keyframes");
        continue;
      }
      const KeyFrame* parent =
          keyframe->parent.value < id ? keyframes_.Find(keyframe->parent.value) : nullptr;
      Require(parent, "a keyframe's parent does not exist");
      Require(parent->map == keyframe->map, "a keyframe's parent is in another map");
    }
  }

  void CheckTies(const KeyFrame& keyframe) {
    for (const Neighbour& neighbour : keyframe.covisible) {
      const KeyFrame* other = keyframes_.Find(neighbour.id.value);
      Require(other && other != &keyframe && neighbour.shared > 0,
              "a keyframe's neighbor does not exist");
    }
    for (KeyFrameId id : keyframe.loops) {
      const KeyFrame* other = keyframes_.Find(id.value);
      Require(other && other != &keyframe && other->map == keyframe.map &&
                  std::binary_search(other->loops.begin(), other->loops.end(), keyframe.id),
              "a loop refers to a keyframe that does not exist");
    }
  }

  void ReadWorlds(MapState& state) {
    constexpr double kUnit = 1e-6;  // of the length of a direction
    const auto is_sigma = [](double sigma) { return std::isfinite(sigma) && sigma >= 0; };
    for (uint32_t i = 0; i < SizeOf(file_.worlds()); ++i) {
      const fb::World& from = *file_.worlds()->Get(i);
      MapWorld world{{from.map()}, from.meters(), from.scale_sigma(), {}, from.down_sigma()};
      world.down = from.down() ? PointOf(*from.down()) : Eigen::Vector3d::Zero();
      Require(world.map.value < NextMap(), "a world is of a map that never existed");
      Require(state.worlds.empty() || state.worlds.back().map < world.map,
              "worlds are out of order");
      Require(is_sigma(world.scale_sigma) && is_sigma(world.down_sigma),
              "the standard deviation of a world is not one");
      Require(!from.down() || std::abs(world.down.norm() - 1) < kUnit,
              "the vertical of a world is not a direction");
      state.worlds.push_back(world);
    }
  }

  void ReadLandmark(const fb::Landmark& from) {
    Landmark& landmark =
        landmarks_.Add(from.id(), file_.next_landmark(), "two landmarks have one id");
    Require(from.p_world() && from.descriptor() && from.normal(), "a landmark is incomplete");
    landmark.p_world = PointOf(*from.p_world());
    landmark.descriptor = DecodeDescriptor(*from.descriptor());
    landmark.normal = {from.normal()->x(), from.normal()->y(), from.normal()->z()};
    landmark.min_distance = from.min_distance();
    landmark.max_distance = from.max_distance();
    landmark.static_probability = from.static_probability();
    landmark.scale_known = from.scale_known();
    landmark.depth_assumed = from.depth_assumed();
    landmark.born = {from.born()};
    landmark.reference = {from.reference()};
    if (const char* complaint = ComplaintOf(landmark)) Require(false, complaint);
    Require(landmark.born.value < file_.next_keyframe(),
            "a landmark was created in a keyframe that never existed");
    bool reference_sees_it = false;
    for (uint32_t i = 0; i < SizeOf(from.observations()); ++i) {
      const fb::Observation& seen = *from.observations()->Get(i);
      KeyFrame* keyframe = keyframes_.Find(seen.keyframe());
      Require(keyframe && seen.keypoint() < keyframe->landmarks.size(),
              "a landmark is observed by a keyframe that does not exist");
      Require(landmark.observations.empty() || landmark.observations.back().keyframe < keyframe->id,
              "observations are out of order");
      LandmarkId& shown = keyframe->landmarks[seen.keypoint()];
      Require(!shown.valid(), "a keypoint observes two landmarks");
      shown = landmark.id;
      landmark.observations.push_back({keyframe->id, static_cast<int>(seen.keypoint())});
      reference_sees_it = reference_sees_it || keyframe->id == landmark.reference;
    }
    Require(reference_sees_it, "a landmark's reference keyframe does not observe it");
  }

  const fb::Map& file_;
  ByteBudget budget_;
  Camera camera_;
  Objects<KeyFrame> keyframes_;
  Objects<Landmark> landmarks_;
};

}  // namespace

void CheckMapStart(std::string_view start) {
  constexpr size_t kSmallest = 16;  // bytes needed to read the identifier
  if (start.size() < kSmallest || !fb::MapBufferHasIdentifier(start.data()))
    ThrowInput("not a map of Alidade");
}

SavedMap DecodeMap(std::string_view bytes) {
  CheckMapStart(bytes);
  // FlatBuffers reads numbers in place, which requires aligned data.
  std::vector<uint64_t> aligned;
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  if (reinterpret_cast<uintptr_t>(data) % sizeof(uint64_t) != 0) {
    aligned.resize(bytes.size() / sizeof(uint64_t) + 1);
    std::memcpy(aligned.data(), bytes.data(), bytes.size());
    data = reinterpret_cast<const uint8_t*>(aligned.data());
  }
  if (bytes.size() > FLATBUFFERS_MAX_BUFFER_SIZE) ThrowInput("the map is too large (2 GB)");
  const auto most_tables = static_cast<flatbuffers::uoffset_t>(bytes.size() / 4);
  flatbuffers::Verifier verifier(data, bytes.size(), /*max_depth=*/16, most_tables);
  if (!fb::VerifyMapBuffer(verifier)) ThrowInput("the map is damaged or truncated");
  const fb::Map& file = *fb::GetMap(data);
  if (file.version() > kMapVersion) {
    ThrowInput("the map has format version " + std::to_string(file.version()) +
               ", but this program reads up to version " + std::to_string(kMapVersion) +
               "; use a newer program");
  }
  Require(file.version() > 0, "it has no version");
  Require(file.checksum(), "it has no checksum");
  const auto place = static_cast<size_t>(reinterpret_cast<const uint8_t*>(file.checksum()) - data);
  if (MapChecksum(data, bytes.size(), place) != file.checksum()->fnv1a()) {
    ThrowInput("the map is damaged: its checksum does not match");
  }
  Require(file.next_map() <= file.next_keyframe(), "it has more maps than keyframes");
  return Decoder(file, bytes.size()).Run();
}

}  // namespace alidade
