#include <stdexcept>

#include "alidade/base/error.h"
#include "alidade/map/map_checksum.h"
#include "alidade/map/map_decode_parts.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_generated.h"

namespace alidade {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

fb::Vec3 Encode(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

fb::Pose Encode(const Se3& T) {
  return {Encode(T.R.row(0).transpose()), Encode(T.R.row(1).transpose()),
          Encode(T.R.row(2).transpose()), Encode(T.t)};
}

fb::Descriptor Encode(const Descriptor& d) {
  return {d.words[0], d.words[1], d.words[2], d.words[3]};
}

fb::Keypoint Encode(const Keypoint& k) {
  return {k.x, k.y, k.raw_x, k.raw_y, k.angle, k.response, k.right_x, k.depth, k.level};
}

fb::Neighbour Encode(const Neighbour& n) { return {n.id.value, static_cast<uint32_t>(n.shared)}; }

fb::Observation Encode(const Observation& o) {
  return {o.keyframe.value, static_cast<uint32_t>(o.keypoint)};
}

fb::PlaceNode Encode(const Vocabulary::Node& node) {
  return {Encode(node.centre), node.first_child, node.children};
}

// Encodes a list as a vector of structs.
template <typename Struct, typename Thing>
Offset<flatbuffers::Vector<const Struct*>> EncodeList(FlatBufferBuilder& builder,
                                                      const std::vector<Thing>& things) {
  std::vector<Struct> structs;
  structs.reserve(things.size());
  for (const Thing& thing : things) structs.push_back(Encode(thing));
  return builder.CreateVectorOfStructs(structs);
}

Offset<fb::KeyFrame> EncodeKeyFrame(FlatBufferBuilder& builder, const KeyFrame& keyframe) {
  const auto keypoints = EncodeList<fb::Keypoint>(builder, keyframe.frame->keypoints);
  const auto descriptors = EncodeList<fb::Descriptor>(builder, keyframe.frame->descriptors);
  const auto covisible = EncodeList<fb::Neighbour>(builder, keyframe.covisible);
  std::vector<uint32_t> loop_ids;
  for (KeyFrameId id : keyframe.loops) loop_ids.push_back(id.value);
  const auto loops = builder.CreateVector(loop_ids);
  const fb::Pose pose = Encode(keyframe.T_camera_world);
  return fb::CreateKeyFrame(builder, keyframe.id.value, keyframe.parent.value,
                            keyframe.frame->number, keyframe.frame->time, &pose, keypoints,
                            descriptors, covisible, keyframe.map.value, keyframe.scale, loops);
}

Offset<fb::Landmark> EncodeLandmark(FlatBufferBuilder& builder, const Landmark& landmark) {
  const auto observations = EncodeList<fb::Observation>(builder, landmark.observations);
  const fb::Vec3 p_world = Encode(landmark.p_world);
  const fb::Vec3f normal(landmark.normal.x(), landmark.normal.y(), landmark.normal.z());
  const fb::Descriptor descriptor = Encode(landmark.descriptor);
  return fb::CreateLandmark(
      builder, landmark.id.value, &p_world, observations, landmark.reference.value,
      landmark.born.value, &descriptor, &normal, landmark.min_distance, landmark.max_distance,
      landmark.static_probability, landmark.scale_known, landmark.depth_assumed);
}

Offset<fb::Camera> EncodeCamera(FlatBufferBuilder& builder, const Camera& camera) {
  const auto distortion = builder.CreateVector(camera.distortion.data(), camera.distortion.size());
  return fb::CreateCamera(builder, camera.width, camera.height, camera.fx, camera.fy, camera.cx,
                          camera.cy, distortion, camera.fps, camera.depth_factor, camera.baseline,
                          camera.readout[0], camera.readout[1], camera.focal_sigma);
}

// Of maps that exist.
std::vector<Offset<fb::World>> EncodeWorlds(FlatBufferBuilder& builder, const MapSnapshot& map) {
  std::vector<Offset<fb::World>> worlds;
  for (MapId id : map.Maps()) {
    const MapWorld* world = map.WorldOf(id);
    if (!world) continue;
    const fb::Vec3 down = Encode(world->down);
    worlds.push_back(fb::CreateWorld(builder, id.value, world->meters, world->scale_sigma,
                                     world->KnowsDown() ? &down : nullptr, world->down_sigma));
  }
  return worlds;
}

// Checks the FlatBuffers limit of 2 GB (about 25,000 keyframes with 1000 keypoints), since the
// builder does not report an overflow.
void CheckSize(const MapState& state) {
  constexpr size_t kKeyFrame = 512, kLandmark = 256;  // bytes in addition to lists, upper bounds
  size_t bytes = 0;
  state.keyframes.ForEach([&](const KeyFrame& keyframe) {
    bytes += kKeyFrame + keyframe.loops.size() * sizeof(uint32_t) +
             keyframe.frame->keypoints.size() * (sizeof(fb::Keypoint) + sizeof(fb::Descriptor)) +
             keyframe.covisible.size() * sizeof(fb::Neighbour);
  });
  state.landmarks.ForEach([&](const Landmark& landmark) {
    bytes += kLandmark + landmark.observations.size() * sizeof(fb::Observation);
  });
  if (bytes > FLATBUFFERS_MAX_BUFFER_SIZE) {
    ThrowInput(
        "the map is too large for one file (2 GB): " + std::to_string(state.keyframes.size()) +
        " keyframes, " + std::to_string(state.landmarks.size()) + " landmarks");
  }
}

}  // namespace

std::string EncodeMap(const SavedMap& saved) {
  const MapState& state = saved.map.state();
  CheckSize(state);
  FlatBufferBuilder builder(1 << 16);  // initial size, bytes
  std::vector<Offset<fb::KeyFrame>> keyframes;
  state.keyframes.ForEach(
      [&](const KeyFrame& keyframe) { keyframes.push_back(EncodeKeyFrame(builder, keyframe)); });
  std::vector<Offset<fb::Landmark>> landmarks;
  state.landmarks.ForEach([&](const Landmark& landmark) {
    if (!ComplaintOf(landmark)) landmarks.push_back(EncodeLandmark(builder, landmark));
  });
  std::vector<Offset<fb::Setting>> settings;
  for (const auto& [name, value] : saved.settings) {
    settings.push_back(fb::CreateSettingDirect(builder, name.c_str(), value.c_str()));
  }
  const auto nodes = EncodeList<fb::PlaceNode>(builder, saved.places.nodes);
  const auto places = fb::CreatePlaces(builder, nodes, saved.places.grown_at);
  const auto worlds = EncodeWorlds(builder, saved.map);
  const fb::Checksum unknown(0);
  const auto root = fb::CreateMapDirect(
      builder, kMapVersion, &unknown, saved.sensor.c_str(), EncodeCamera(builder, saved.camera),
      &settings, state.next_keyframe, state.next_landmark, &keyframes, &landmarks, state.next_map,
      places, worlds.empty() ? nullptr : &worlds);
  fb::FinishMapBuffer(builder, root);

  uint8_t* bytes = builder.GetBufferPointer();
  const size_t size = builder.GetSize();
  fb::Checksum* checksum = fb::GetMutableMap(bytes)->mutable_checksum();
  const auto place = static_cast<size_t>(reinterpret_cast<const uint8_t*>(checksum) - bytes);
  checksum->mutate_fnv1a(MapChecksum(bytes, size, place));
  std::string written(reinterpret_cast<const char*>(bytes), size);
  builder.Clear();
  try {
    DecodeMap(written);
  } catch (const Error& error) {
    throw std::logic_error(std::string("the map is inconsistent: ") + error.what());
  }
  return written;
}

}  // namespace alidade
