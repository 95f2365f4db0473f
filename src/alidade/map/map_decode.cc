#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "alidade/base/error.h"
#include "alidade/map/map_checksum.h"
#include "alidade/map/map_file.h"
#include "alidade/map/map_generated.h"

namespace alidade {
namespace {

// Ids are places in tables: more than this many come from no recording, but would take all memory.
constexpr uint32_t kMaxIds = 1u << 26;

// What is read has passed the verifier: every offset points inside. Whether it makes sense is
// looked at here.
void Require(bool holds, const char* what) {
  if (!holds) ThrowInput(std::string("the map contradicts itself: ") + what);
}

template <typename Vector>
size_t SizeOf(const Vector* vector) {
  return vector ? vector->size() : 0;
}

bool Finite(const Eigen::Vector3d& v) { return v.allFinite(); }

Eigen::Vector3d Decode(const fb::Vec3& v) { return {v.x(), v.y(), v.z()}; }

Descriptor Decode(const fb::Descriptor& d) {
  return {{d.word0(), d.word1(), d.word2(), d.word3()}};
}

Se3 DecodePose(const fb::Pose* pose) {
  Require(pose, "a keyframe has no pose");
  Se3 T;
  T.R.row(0) = Decode(pose->row0()).transpose();
  T.R.row(1) = Decode(pose->row1()).transpose();
  T.R.row(2) = Decode(pose->row2()).transpose();
  T.t = Decode(pose->t());
  const Eigen::Matrix3d error = T.R * T.R.transpose() - Eigen::Matrix3d::Identity();
  Require(
      T.R.allFinite() && error.cwiseAbs().maxCoeff() < 1e-6 && T.R.determinant() > 0 && Finite(T.t),
      "a pose is no rigid motion");
  return T;
}

Camera DecodeCamera(const fb::Camera& from) {
  Camera camera;
  camera.width = from.width();
  camera.height = from.height();
  camera.fx = from.fx();
  camera.fy = from.fy();
  camera.cx = from.cx();
  camera.cy = from.cy();
  Require(SizeOf(from.distortion()) == camera.distortion.size(),
          "the camera's distortion has not 5 numbers");
  for (size_t i = 0; i < camera.distortion.size(); ++i) {
    camera.distortion[i] = from.distortion()->Get(static_cast<uint32_t>(i));
  }
  camera.fps = from.fps();
  camera.depth_factor = from.depth_factor();
  camera.baseline = from.baseline();
  camera.Check();
  return camera;
}

std::shared_ptr<const Frame> DecodeFrame(const fb::KeyFrame& from, const Camera& camera) {
  auto frame = std::make_shared<Frame>();
  frame->number = from.frame();
  frame->time = from.time();
  Require(std::isfinite(frame->time), "a keyframe's time is not a number");
  Require(SizeOf(from.keypoints()) == SizeOf(from.descriptors()),
          "keypoints and descriptors differ in number");
  frame->keypoints.reserve(SizeOf(from.keypoints()));
  frame->descriptors.reserve(SizeOf(from.keypoints()));
  for (uint32_t i = 0; i < SizeOf(from.keypoints()); ++i) {
    const fb::Keypoint& k = *from.keypoints()->Get(i);
    const Keypoint keypoint{k.x(),        k.y(),       k.raw_x(), k.raw_y(), k.angle(),
                            k.response(), k.right_x(), k.depth(), k.level()};
    for (float v :
         {k.x(), k.y(), k.raw_x(), k.raw_y(), k.angle(), k.response(), k.right_x(), k.depth()}) {
      Require(std::isfinite(v), "a keypoint has something that is not a number");
    }
    Require(keypoint.level >= 0 && keypoint.level < kPyramidLevels,
            "a keypoint is on no pyramid level");
    frame->keypoints.push_back(keypoint);
    frame->descriptors.push_back(Decode(*from.descriptors()->Get(i)));
  }
  frame->grid = KeypointGrid(frame->keypoints, camera.width, camera.height);
  return frame;
}

// Builds the tables of a MapState by id.
template <typename Object>
class TableFiller {
 public:
  TableFiller(uint32_t next, const char* what) : objects_(next), what_(what) {}

  Object& Add(uint32_t id) {
    Require(id < objects_.size() && !objects_[id], what_);
    objects_[id] = std::make_shared<Object>();
    objects_[id]->id = {id};
    return *objects_[id];
  }
  Object* Find(uint32_t id) { return id < objects_.size() ? objects_[id].get() : nullptr; }

  MapTable<Object> Finish(int alive) const {
    MapTable<Object> table;
    table.next = static_cast<uint32_t>(objects_.size());
    table.alive = alive;
    for (uint32_t begin = 0; begin < table.next; begin += MapPage<Object>::kSize) {
      auto page = std::make_shared<MapPage<Object>>();
      const uint32_t end = std::min(table.next, begin + MapPage<Object>::kSize);
      for (uint32_t i = begin; i < end; ++i) page->slots[i - begin] = objects_[i];
      table.pages.push_back(std::move(page));
    }
    return table;
  }

 private:
  std::vector<std::shared_ptr<Object>> objects_;
  const char* what_;
};

class Decoder {
 public:
  explicit Decoder(const fb::Map& file)
      : file_(file),
        camera_(DecodeCamera(*file.camera())),
        keyframes_(file.next_keyframe(), "two keyframes have one id"),
        landmarks_(file.next_landmark(), "two landmarks have one id") {}

  SavedMap Run(size_t file_size) {
    ReadKeyFrames(file_size);
    CheckTree();
    for (uint32_t i = 0; i < SizeOf(file_.landmarks()); ++i)
      ReadLandmark(*file_.landmarks()->Get(i));
    for (uint32_t i = 0; i < SizeOf(file_.forwards()); ++i) ReadForward(*file_.forwards()->Get(i));

    SavedMap saved;
    saved.version = file_.version();
    saved.camera = camera_;
    saved.sensor = file_.sensor()->str();
    Require(saved.sensor == "mono" || saved.sensor == "stereo" || saved.sensor == "rgbd",
            "its sensor is unknown");
    for (uint32_t i = 0; i < SizeOf(file_.settings()); ++i) {
      const fb::Setting& setting = *file_.settings()->Get(i);
      saved.settings.push_back({setting.name()->str(), setting.value()->str()});
    }
    auto state = std::make_shared<MapState>();
    state->keyframes = keyframes_.Finish(static_cast<int>(SizeOf(file_.keyframes())));
    state->landmarks = landmarks_.Finish(static_cast<int>(SizeOf(file_.landmarks())));
    state->next_map = state->keyframes.next > 0;
    saved.map = MapSnapshot(std::move(state));
    return saved;
  }

 private:
  void ReadKeyFrames(size_t file_size) {
    size_t keypoint_bytes = 0;  // several keyframes could point at one list, and fill all memory
    for (uint32_t i = 0; i < SizeOf(file_.keyframes()); ++i) {
      const fb::KeyFrame& from = *file_.keyframes()->Get(i);
      keypoint_bytes += SizeOf(from.keypoints()) * sizeof(fb::Keypoint);
      keypoint_bytes += SizeOf(from.covisible()) * sizeof(fb::Neighbour);
      Require(keypoint_bytes <= file_size, "keyframes share their keypoints");
      KeyFrame& keyframe = keyframes_.Add(from.id());
      keyframe.frame = DecodeFrame(from, camera_);
      keyframe.T_camera_world = DecodePose(from.t_camera_world());
      keyframe.parent = {from.parent()};
      keyframe.map = {0};
      keyframe.landmarks.resize(keyframe.frame->keypoints.size());
      for (uint32_t n = 0; n < SizeOf(from.covisible()); ++n) {
        const fb::Neighbour& neighbour = *from.covisible()->Get(n);
        keyframe.covisible.push_back(
            {{neighbour.keyframe()}, static_cast<int>(neighbour.shared())});
      }
    }
    for (uint32_t i = 0; i < SizeOf(file_.culled()); ++i) {
      const fb::CulledKeyFrame& from = *file_.culled()->Get(i);
      KeyFrame& keyframe = keyframes_.Add(from.id());
      keyframe.parent = {from.parent()};
      keyframe.T_camera_parent = DecodePose(from.t_camera_parent());
      Require(keyframe.parent.valid(), "a culled keyframe has no parent");
    }
  }

  // Parents come first, so that there are no rings, and the living do not hang on the culled.
  void CheckTree() {
    for (uint32_t id = 0; id < file_.next_keyframe(); ++id) {
      const KeyFrame* keyframe = keyframes_.Find(id);
      if (!keyframe) continue;
      if (keyframe->parent.valid()) {
        const KeyFrame* parent =
            keyframe->parent.value < id ? keyframes_.Find(keyframe->parent.value) : nullptr;
        Require(parent && (keyframe->culled() || !parent->culled()),
                "a keyframe's parent is not there");
      }
      for (const Neighbour& n : keyframe->covisible) {
        const KeyFrame* other = keyframes_.Find(n.id.value);
        Require(other && !other->culled() && other != keyframe && n.shared > 0,
                "a keyframe's neighbour is not there");
      }
    }
  }

  void ReadLandmark(const fb::Landmark& from) {
    Landmark& landmark = landmarks_.Add(from.id());
    Require(from.p_world() && from.descriptor() && from.normal(), "a landmark is incomplete");
    landmark.p_world = Decode(*from.p_world());
    landmark.descriptor = Decode(*from.descriptor());
    landmark.normal = {from.normal()->x(), from.normal()->y(), from.normal()->z()};
    landmark.min_distance = from.min_distance();
    landmark.max_distance = from.max_distance();
    landmark.born = {from.born()};
    landmark.reference = {from.reference()};
    Require(Finite(landmark.p_world) && landmark.normal.allFinite() &&
                std::isfinite(landmark.min_distance) && std::isfinite(landmark.max_distance),
            "a landmark has something that is not a number");
    Require(landmark.born.value < file_.next_keyframe(),
            "a landmark was born in a keyframe that never was");
    bool reference_sees_it = false;
    for (uint32_t i = 0; i < SizeOf(from.observations()); ++i) {
      const fb::Observation& seen = *from.observations()->Get(i);
      KeyFrame* keyframe = keyframes_.Find(seen.keyframe());
      Require(keyframe && seen.keypoint() < keyframe->landmarks.size(),
              "a landmark is seen by what is not there");
      Require(landmark.observations.empty() || landmark.observations.back().keyframe < keyframe->id,
              "observations are out of order");
      LandmarkId& shown = keyframe->landmarks[seen.keypoint()];
      Require(!shown.valid(), "a keypoint shows two landmarks");
      shown = landmark.id;
      landmark.observations.push_back({keyframe->id, static_cast<int>(seen.keypoint())});
      reference_sees_it = reference_sees_it || keyframe->id == landmark.reference;
    }
    Require(reference_sees_it, "a landmark's reference keyframe does not see it");
  }

  void ReadForward(const fb::Forward& from) {
    const Landmark* by = landmarks_.Find(from.by());
    Require(by && !by->replaced_by.valid(), "a landmark was fused into one that is not there");
    landmarks_.Add(from.old()).replaced_by = by->id;
  }

  const fb::Map& file_;
  Camera camera_;
  TableFiller<KeyFrame> keyframes_;
  TableFiller<Landmark> landmarks_;
};

}  // namespace

SavedMap DecodeMap(std::string_view bytes) {
  // Numbers are read where they lie, which must be a multiple of their size.
  std::vector<uint64_t> aligned;
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  if (reinterpret_cast<uintptr_t>(data) % sizeof(uint64_t) != 0) {
    aligned.resize(bytes.size() / sizeof(uint64_t) + 1);
    std::memcpy(aligned.data(), bytes.data(), bytes.size());
    data = reinterpret_cast<const uint8_t*>(aligned.data());
  }
  constexpr size_t kSmallest = 16;  // to look at the identifier at all
  if (bytes.size() < kSmallest || !fb::MapBufferHasIdentifier(data))
    ThrowInput("not a map of Alidade");
  if (bytes.size() > FLATBUFFERS_MAX_BUFFER_SIZE)
    ThrowInput("the map is too large to be one (2 GB)");
  const auto most_tables = static_cast<flatbuffers::uoffset_t>(bytes.size() / 4);
  flatbuffers::Verifier verifier(data, bytes.size(), /*max_depth=*/16, most_tables);
  if (!fb::VerifyMapBuffer(verifier)) ThrowInput("the map is damaged or cut short");
  const fb::Map& file = *fb::GetMap(data);
  if (file.version() > kMapVersion) {
    ThrowInput("the map has format version " + std::to_string(file.version()) +
               ", this program reads up to " + std::to_string(kMapVersion) + "; use a newer one");
  }
  Require(file.checksum(), "it has no checksum");
  const auto place = static_cast<size_t>(reinterpret_cast<const uint8_t*>(file.checksum()) - data);
  if (MapChecksum(data, bytes.size(), place) != file.checksum()->fnv1a()) {
    ThrowInput("the map is damaged: its checksum does not match");
  }
  Require(file.next_keyframe() <= kMaxIds && file.next_landmark() <= kMaxIds,
          "it has too many ids");
  return Decoder(file).Run(bytes.size());
}

}  // namespace alidade
