#include "alidade/stream/stream_scene.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/stream/pack.h"
#include "alidade/stream/thin.h"

namespace alidade {
namespace {

[[noreturn]] void Refuse(const std::string& what) { ThrowInput("the stream is damaged: " + what); }

Se3 PoseFrom(const stream::Pose* pose, const char* whose) {
  if (!pose) Refuse(std::string("no pose of ") + whose);
  const double norm =
      std::hypot(std::hypot(pose->qx(), pose->qy()), std::hypot(pose->qz(), pose->qw()));
  const bool finite =
      std::isfinite(pose->tx()) && std::isfinite(pose->ty()) && std::isfinite(pose->tz());
  if (!finite || !(std::abs(norm - 1) < 1e-3)) Refuse(std::string("a pose of ") + whose);
  return UnpackPose(*pose);
}

double ScaleFrom(double scale) {
  if (!(scale > 0) || !std::isfinite(scale)) Refuse("a scale");
  return scale;
}

std::vector<uint32_t> ListFrom(const flatbuffers::Vector<uint32_t>* list) {
  return list ? std::vector<uint32_t>(list->begin(), list->end()) : std::vector<uint32_t>();
}

std::string TextFrom(const flatbuffers::String* text) { return text ? text->str() : ""; }

void Check(const flatbuffers::Vector<uint8_t>* bytes, size_t each, const char* what) {
  if (bytes && bytes->size() % each != 0) Refuse(std::string("half a ") + what);
}

uint64_t NextTold() {
  static std::atomic<uint64_t> last{0};
  return ++last;
}

void TakeKeyFrame(const stream::KeyFrame& told, StreamScene& scene) {
  SceneKeyFrame& keyframe = scene.keyframes[{told.id()}];
  keyframe.map = {told.map()};
  keyframe.parent = {told.parent()};
  keyframe.number = told.number();
  keyframe.time = told.time();
  keyframe.T_world_camera = PoseFrom(told.t_world_camera(), "a keyframe");
  keyframe.scale = ScaleFrom(told.scale());
  keyframe.covisible = ListFrom(told.covisible());
  keyframe.loops = ListFrom(told.loops());
}

// Re-anchors frames of the culled keyframe to the keyframe that replaces it.
void TakeCull(const stream::Culled& cull, StreamScene& scene) {
  const Se3 T_follows_culled = PoseFrom(&cull.t_follows_culled(), "what was culled");
  const double scale = ScaleFrom(cull.scale());
  for (SceneFrame& frame : scene.path) {
    if (frame.reference.value != cull.id()) continue;
    frame.reference = {cull.follows()};
    frame.T_reference_camera.t *= scale;
    frame.T_reference_camera = T_follows_culled * frame.T_reference_camera;
  }
  scene.keyframes.erase({cull.id()});
}

MapWorld WorldFrom(const stream::World& told) {
  MapWorld world{{told.map()},
                 told.meters(),
                 told.scale_sigma(),
                 {told.down_x(), told.down_y(), told.down_z()},
                 told.down_sigma()};
  const bool unit = std::abs(world.down.norm() - 1) < 1e-6;
  if (world.KnowsDown() && !unit) Refuse("the direction of gravity");
  if (!(world.scale_sigma >= 0) || !(world.down_sigma >= 0) || !std::isfinite(world.scale_sigma) ||
      !std::isfinite(world.down_sigma))
    Refuse("a standard deviation of a map's world");
  return world;
}

void TakeChange(const stream::MapChange& change, StreamScene& scene) {
  if (change.whole()) {
    scene.keyframes.clear();
    scene.worlds.clear();
    scene.landmarks.clear();
    scene.path.clear();
    scene.events.clear();
  }
  scene.version = change.version();
  scene.told = NextTold();
  if (change.keyframes()) {
    for (const stream::KeyFrame* told : *change.keyframes()) TakeKeyFrame(*told, scene);
  }
  if (change.moves()) {
    for (const stream::Move* move : *change.moves()) {
      const auto found = scene.keyframes.find({move->id()});
      if (found == scene.keyframes.end()) Refuse("a moved keyframe is unknown");
      found->second.T_world_camera = PoseFrom(&move->t_world_camera(), "a keyframe");
      found->second.scale = ScaleFrom(move->scale());
    }
  }
  Check(change.landmarks(), kPackedLandmark, "landmark");
  for (size_t i = 0; change.landmarks() && i < change.landmarks()->size(); i += kPackedLandmark) {
    const auto [id, told] = UnpackLandmark(change.landmarks()->data() + i);
    if (!told.p.allFinite() || scene.keyframes.count(told.keyframe) == 0) Refuse("a landmark");
    scene.landmarks[id] = {told.keyframe, told.p};
  }
  if (change.removed_landmarks()) {
    for (uint32_t id : *change.removed_landmarks()) scene.landmarks.erase({id});
  }
  if (change.culled()) {
    for (const stream::Culled* cull : *change.culled()) TakeCull(*cull, scene);
  }
  for (size_t i = 0; change.depth() && i < change.depth()->size(); ++i) {
    const stream::DepthCloud& cloud = *change.depth()->Get(static_cast<unsigned>(i));
    const auto found = scene.keyframes.find({cloud.keyframe()});
    if (found == scene.keyframes.end()) Refuse("depth of an unknown keyframe");
    Check(cloud.points(), kPackedPoint, "point");
    const bool any = cloud.points() && cloud.points()->size() > 0;
    if (any && !(cloud.least() > 0 && cloud.most() >= cloud.least() && std::isfinite(cloud.most())))
      Refuse("a range of depth");
    found->second.depth_least = cloud.least();
    found->second.depth_most = cloud.most();
    found->second.depth_told = scene.told;
    found->second.depth.clear();
    if (any) {
      found->second.depth.assign(reinterpret_cast<const char*>(cloud.points()->data()),
                                 cloud.points()->size());
    }
  }
  if (change.tells_worlds()) scene.worlds.clear();
  if (change.tells_worlds() && change.worlds()) {
    for (const stream::World* told : *change.worlds()) scene.worlds.push_back(WorldFrom(*told));
  }
  if (change.path()) {
    for (const stream::PathFrame* told : *change.path()) {
      SceneFrame frame{told->number(), static_cast<int>(told->state()), told->time(), {}, {}};
      if (scene.keyframes.count({told->reference()}) != 0) {
        frame.reference = {told->reference()};
        frame.T_reference_camera = PoseFrom(&told->t_reference_camera(), "a frame");
      }
      scene.path.push_back(frame);
    }
  }
}

void TakeCamera(const stream::Camera& told, StreamScene& scene) {
  Camera& camera = scene.camera;
  scene.width = camera.width = told.width();
  scene.height = camera.height = told.height();
  camera.fx = told.fx();
  camera.fy = told.fy();
  camera.cx = told.cx();
  camera.cy = told.cy();
  camera.baseline = told.baseline();
  camera.distortion = {};
  if (const auto* k = told.distortion(); k && k->size() == camera.distortion.size())
    std::copy(k->begin(), k->end(), camera.distortion.begin());
  if (const auto* turn = told.r_camera_rectified()) {
    if (turn->size() != 9) Refuse("a rotation of the camera");
    for (unsigned i = 0; i < 9; ++i) scene.R_camera_rectified(i / 3, i % 3) = turn->Get(i);
    const Eigen::Matrix3d& R = scene.R_camera_rectified;
    if (!(R * R.transpose()).isIdentity(1e-6)) Refuse("a rotation of the camera");
  }
}

void TakeNow(const stream::Frame& told, SceneNow& now) {
  now = {};
  now.number = told.number();
  now.state = static_cast<int>(told.state());
  now.time = told.time();
  if (static_cast<int>(told.failure()) < kTrackFailures)  // else of a later version
    now.failure = static_cast<TrackFailure>(told.failure());
  now.reason =
      told.failure() == stream::Failure::none ? TextFrom(told.reason()) : ReasonText(now.failure);
  now.map = {told.map()};
  if (told.state() == stream::State::tracking)
    now.T_world_camera = PoseFrom(told.t_world_camera(), "a frame");
  if (told.predicted()) now.T_world_guess = PoseFrom(told.t_world_camera(), "a frame");
  now.keyframes = told.keyframes();
  now.landmarks = told.landmarks();
  now.matches = told.matches();
  now.maps = told.maps();
  if (told.ms()) now.ms.assign(told.ms()->begin(), told.ms()->end());
  const stream::Picture* picture = told.picture();
  if (!picture || !picture->bytes()) return;
  now.picture_width = picture->width();
  now.picture_height = picture->height();
  now.picture_type = TextFrom(picture->type());
  now.picture.assign(reinterpret_cast<const char*>(picture->bytes()->data()),
                     picture->bytes()->size());
}

void TakeFrame(const stream::Frame& told, StreamScene& scene) {
  Check(told.features(), kPackedFeature, "feature");
  SceneFrame frame{told.number(), static_cast<int>(told.state()), told.time(), {}, {}};
  if (told.reference() != KeyFrameId::kNone) {
    if (scene.keyframes.count({told.reference()}) == 0) Refuse("a frame has no reference keyframe");
    frame.reference = {told.reference()};
    frame.T_reference_camera = PoseFrom(told.t_reference_camera(), "a frame");
  }
  if (scene.path.size() >= scene.most_frames) ThinOlderHalf(scene.path);
  scene.path.push_back(frame);
  TakeNow(told, scene.now);
  ++scene.frames;
  scene.told_keyframes = told.keyframes();
  scene.told_landmarks = told.landmarks();
  scene.matches = told.matches();
  scene.features.clear();
  for (size_t i = 0; told.features() && i < told.features()->size(); i += kPackedFeature) {
    const uint8_t* bytes = told.features()->data() + i;
    const auto place = [](const uint8_t* at) { return static_cast<uint16_t>(at[0] | at[1] << 8); };
    scene.features.push_back({UnpackPlace(place(bytes), scene.width),
                              UnpackPlace(place(bytes + 2), scene.height), bytes[4]});
  }
  scene.boxes.clear();
  if (told.detections()) {
    for (const stream::Detection* box : *told.detections()) {
      scene.boxes.push_back({box->x(), box->y(), box->width(), box->height(), box->score(),
                             box->label() ? box->label()->str() : ""});
    }
  }
  scene.detection_age = told.detection_age();
  scene.outlines = told.outlines() ? static_cast<int>(told.outlines()->size()) : 0;
}

}  // namespace

void StreamScene::Take(std::string_view bytes) {
  // FlatBuffers reads numbers in place and requires their original alignment.
  std::vector<uint64_t> aligned((bytes.size() + 7) / 8);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(aligned.data()));
  const auto* data = reinterpret_cast<const uint8_t*>(aligned.data());
  flatbuffers::Verifier verifier(data, bytes.size());
  if (bytes.size() < 12 || !stream::MessageBufferHasIdentifier(data) ||
      !stream::VerifyMessageBuffer(verifier)) {
    Refuse("a message cannot be decoded");
  }
  const stream::Message& message = *stream::GetMessage(data);
  if (const stream::Hello* hello = message.body_as_Hello()) {
    if (hello->version() > 1) ThrowInput("the stream has a newer version");
    if (hello->camera()) TakeCamera(*hello->camera(), *this);
    source = TextFrom(hello->source());
    unit = TextFrom(hello->unit());
  } else if (const stream::MapChange* change = message.body_as_MapChange()) {
    TakeChange(*change, *this);
  } else if (const stream::Frame* frame = message.body_as_Frame()) {
    TakeFrame(*frame, *this);
  } else if (const stream::Event* event = message.body_as_Event()) {
    const stream::EventKind kind = event->kind();
    const bool bad = kind == stream::EventKind::lost || kind == stream::EventKind::cut ||
                     kind == stream::EventKind::given_up || kind == stream::EventKind::warning;
    events.push_back(
        {static_cast<int>(kind), event->number(), event->time(), bad, TextFrom(event->text())});
  }
}

MapId StreamScene::ActiveMap() const {
  for (auto frame = path.rbegin(); frame != path.rend(); ++frame) {
    const auto reference = keyframes.find(frame->reference);
    if (reference != keyframes.end()) return reference->second.map;
  }
  return keyframes.empty() ? MapId{} : keyframes.rbegin()->second.map;
}

std::string StreamScene::UnitOf(MapId map) const {
  const MapWorld* world = FindWorld(worlds, map);
  return world && world->meters ? "m" : unit;
}

std::optional<Se3> StreamScene::CameraPose() const {
  if (!path.empty() && keyframes.count(path.back().reference) != 0) return PoseOf(path.back());
  return now.T_world_guess;
}

Eigen::Vector3d StreamScene::PointOf(const SceneLandmark& landmark) const {
  const SceneKeyFrame& keyframe = keyframes.at(landmark.keyframe);
  return keyframe.T_world_camera * (keyframe.scale * landmark.p.cast<double>());
}

Se3 StreamScene::PoseOf(const SceneFrame& frame) const {
  const SceneKeyFrame& keyframe = keyframes.at(frame.reference);
  Se3 T_reference_camera = frame.T_reference_camera;
  T_reference_camera.t *= keyframe.scale;
  return keyframe.T_world_camera * T_reference_camera;
}

void StreamScene::AddDepth(const SceneKeyFrame& keyframe, Cloud& points_world) const {
  const auto* bytes = reinterpret_cast<const uint8_t*>(keyframe.depth.data());
  for (size_t i = 0; i + kPackedPoint <= keyframe.depth.size(); i += kPackedPoint) {
    const CloudPoint point =
        UnpackPoint(bytes + i, keyframe.depth_least, keyframe.depth_most, width, height);
    const Eigen::Vector3d p =
        camera.Unproject({point.x, point.y}, keyframe.scale / point.inverse_depth);
    points_world.points.push_back((keyframe.T_world_camera * p).cast<float>());
    points_world.colors.push_back({point.red, point.green, point.blue});
  }
}

}  // namespace alidade
