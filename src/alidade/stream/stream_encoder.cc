#include "alidade/stream/stream_encoder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <utility>

#include "alidade/map/anchor.h"
#include "alidade/stream/pack.h"
#include "alidade/stream/stream_generated.h"
#include "alidade/stream/thin.h"

namespace alidade {
namespace {

namespace fb = flatbuffers;

constexpr size_t kEventsKept = 1000;

template <typename Table>
std::string Finish(fb::FlatBufferBuilder& builder, fb::Offset<Table> body, stream::Body type) {
  stream::FinishMessageBuffer(builder, stream::CreateMessage(builder, type, body.Union()));
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

std::vector<uint32_t> ValuesOf(const std::vector<KeyFrameId>& ids) {
  std::vector<uint32_t> values;
  for (KeyFrameId id : ids) values.push_back(id.value);
  return values;
}

fb::Offset<stream::KeyFrame> EncodeKeyFrame(fb::FlatBufferBuilder& builder, uint32_t id,
                                            const ToldKeyFrame& told) {
  const auto covisible = builder.CreateVector(ValuesOf(told.covisible));
  const auto loops = builder.CreateVector(ValuesOf(told.loops));
  const stream::Pose pose = PackPose(told.T_world_camera);
  return stream::CreateKeyFrame(builder, id, told.map.value, told.parent.value, told.number,
                                told.time, &pose, told.scale, covisible, loops);
}

fb::Offset<stream::DepthCloud> EncodeDepth(fb::FlatBufferBuilder& builder, uint32_t id,
                                           const DepthMap* depth, int most_points) {
  const PackedCloud cloud = depth ? PackCloud(*depth, most_points) : PackedCloud{};
  const auto points = builder.CreateVector(reinterpret_cast<const uint8_t*>(cloud.bytes.data()),
                                           cloud.bytes.size());
  return stream::CreateDepthCloud(builder, id, cloud.least, cloud.most, points);
}

std::vector<stream::World> WorldsOf(const MapSnapshot& map) {
  std::vector<stream::World> worlds;
  for (const MapWorld& w : map.state().worlds) {
    worlds.push_back(
        {w.map.value, w.meters, w.scale_sigma, w.down.x(), w.down.y(), w.down.z(), w.down_sigma});
  }
  return worlds;
}

std::string EncodeEvent(stream::EventKind kind, int number, double time, const std::string& text,
                        uint32_t a = KeyFrameId::kNone, uint32_t b = KeyFrameId::kNone) {
  fb::FlatBufferBuilder builder;
  const auto words = builder.CreateString(text);
  return Finish(builder, stream::CreateEvent(builder, kind, number, time, words, a, b),
                stream::Body::Event);
}

// Outlines of the moving parts of the image as closed polygons.
fb::Offset<fb::Vector<fb::Offset<stream::Outline>>> EncodeOutlines(fb::FlatBufferBuilder& builder,
                                                                   const cv::Mat& mask,
                                                                   double tolerance) {
  std::vector<fb::Offset<stream::Outline>> outlines;
  std::vector<std::vector<cv::Point>> contours;
  if (!mask.empty()) cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
  for (const auto& contour : contours) {
    std::vector<cv::Point> simple;
    cv::approxPolyDP(contour, simple, tolerance, true);
    if (simple.size() < 3) continue;
    std::vector<uint16_t> points;
    for (const cv::Point& point : simple) {
      points.push_back(PackPlace(point.x, mask.cols));
      points.push_back(PackPlace(point.y, mask.rows));
    }
    outlines.push_back(stream::CreateOutlineDirect(builder, &points));
  }
  return builder.CreateVector(outlines);
}

std::string Words(TrackState state, const std::string& reason) {
  if (state == TrackState::kTracking) return "";
  return reason.empty() ? "no pose" : reason;
}

}  // namespace

// Poses of past frames, relative to keyframes.
struct StreamEncoder::Path {
  struct Entry {
    int number = 0;
    TrackState state = TrackState::kInitializing;
    KeyFrameId reference;
    double time = 0;
    Se3 T_reference_camera;
  };
  std::vector<Entry> entries;
  std::map<KeyFrameId, std::vector<size_t>> of;  // indices of entries, by reference

  void Add(const Entry& entry, size_t most) {
    if (entries.size() >= most) Thin();
    if (entry.reference.valid()) of[entry.reference].push_back(entries.size());
    entries.push_back(entry);
  }
  void Thin() {
    ThinOlderHalf(entries);
    of.clear();
    for (size_t i = 0; i < entries.size(); ++i) {
      if (entries[i].reference.valid()) of[entries[i].reference].push_back(i);
    }
  }
  void Cull(const ToldCull& cull) {
    const auto found = of.find(cull.id);
    if (found == of.end()) return;
    const std::vector<size_t> mine = std::move(found->second);
    of.erase(found);
    for (size_t i : mine) {
      Entry& entry = entries[i];
      entry.reference = cull.follows;
      entry.T_reference_camera.t *= cull.scale;
      entry.T_reference_camera = cull.T_follows_culled * entry.T_reference_camera;
    }
    if (!cull.follows.valid()) return;
    std::vector<size_t>& theirs = of[cull.follows];
    theirs.insert(theirs.end(), mine.begin(), mine.end());
  }
};

StreamEncoder::StreamEncoder(StreamSource source, const StreamSettings& settings)
    : source_(std::move(source)),
      settings_(settings),
      told_(settings),
      path_(std::make_unique<Path>()) {
  settings.Check();
}

StreamEncoder::~StreamEncoder() = default;

std::string StreamEncoder::Hello() const {
  fb::FlatBufferBuilder builder;
  const Camera& c = source_.camera;
  const std::vector<double> distortion(c.distortion.begin(), c.distortion.end());
  std::vector<double> turn;  // row-major
  if (!source_.R_camera_rectified.isIdentity(0)) {
    for (int i = 0; i < 9; ++i) turn.push_back(source_.R_camera_rectified(i / 3, i % 3));
  }
  const auto camera = stream::CreateCameraDirect(
      builder, static_cast<uint16_t>(c.width), static_cast<uint16_t>(c.height), c.fx, c.fy, c.cx,
      c.cy, &distortion, c.baseline, turn.empty() ? nullptr : &turn);
  std::vector<stream::TruePose> truth;
  for (const StreamTruth& pose : source_.truth)
    truth.push_back({pose.time, PackPose(pose.T_world_camera)});
  const auto hello = stream::CreateHelloDirect(
      builder, 1, source_.program.c_str(), source_.source.c_str(), source_.sensor.c_str(),
      source_.unit.c_str(), source_.frames, source_.live, camera, &truth);
  return Finish(builder, hello, stream::Body::Hello);
}

std::string StreamEncoder::Playback(const StreamPlayback& playback) const {
  fb::FlatBufferBuilder builder;
  return Finish(
      builder,
      stream::CreatePlayback(builder, playback.paused, playback.finished, playback.may_pause),
      stream::Body::Playback);
}

std::string StreamEncoder::EncodeNews(const MapNews& news) const {
  fb::FlatBufferBuilder builder(65536);
  std::vector<fb::Offset<stream::KeyFrame>> keyframes;
  for (KeyFrameId id : news.keyframes)
    keyframes.push_back(EncodeKeyFrame(builder, id.value, told_.keyframes().at(id.value)));
  std::vector<stream::Move> moves;
  for (KeyFrameId id : news.moved) {
    const ToldKeyFrame& told = told_.keyframes().at(id.value);
    moves.push_back({id.value, told.scale, PackPose(told.T_world_camera)});
  }
  std::vector<uint8_t> landmarks;
  for (LandmarkId id : news.landmarks) PackLandmark(id, told_.landmarks().at(id.value), landmarks);
  std::vector<uint32_t> removed;
  for (LandmarkId id : news.removed_landmarks) removed.push_back(id.value);
  std::vector<stream::Culled> culled;
  for (const ToldCull& cull : news.culled)
    culled.push_back(
        {cull.id.value, cull.follows.value, cull.scale, PackPose(cull.T_follows_culled)});
  std::vector<fb::Offset<stream::DepthCloud>> depths;
  for (KeyFrameId id : news.depths) {
    depths.push_back(EncodeDepth(builder, id.value, told_.keyframes().at(id.value).depth.get(),
                                 settings_.depth_points));
  }
  const std::vector<stream::World> worlds = WorldsOf(told_.snapshot());
  const auto change = stream::CreateMapChangeDirect(
      builder, told_.snapshot().version(), false, &keyframes, &moves, &landmarks, &removed, &culled,
      &depths, nullptr, news.worlds, news.worlds ? &worlds : nullptr);
  return Finish(builder, change, stream::Body::MapChange);
}

void StreamEncoder::TellMap(const MapSnapshot& map, int number, double time,
                            std::vector<std::string>& messages) {
  const MapNews news = told_.Update(map);
  for (const ToldCull& cull : news.culled) path_->Cull(cull);
  if (!news.empty()) messages.push_back(EncodeNews(news));
  if (!news.keyframes.empty() || !news.culled.empty())
    maps_ = static_cast<uint32_t>(map.Maps().size());
  const auto event = [&](stream::EventKind kind, const std::string& text,
                         uint32_t a = KeyFrameId::kNone, uint32_t b = KeyFrameId::kNone) {
    messages.push_back(EncodeEvent(kind, number, time, text, a, b));
    events_.push_back(messages.back());
  };
  for (MapId begun : news.begun) {
    if (begun.value > 0) event(stream::EventKind::new_map, "new map", begun.value);
  }
  for (const auto& [a, b] : news.loops)
    event(stream::EventKind::loop, "loop closed", a.value, b.value);
  for (const auto& [a, b] : news.merged)
    event(stream::EventKind::merge, "maps merged", a.value, b.value);
  for (MapId map_id : news.given_up)
    event(stream::EventKind::given_up, "map dropped", map_id.value);
}

void StreamEncoder::TellState(const StreamFrame& frame, std::vector<std::string>& messages) {
  const TrackState state = frame.result.state;
  const std::string reason = Words(state, frame.result.reason());
  const auto event = [&](stream::EventKind kind, const std::string& text) {
    messages.push_back(EncodeEvent(kind, frame.number, frame.time, text));
    events_.push_back(messages.back());
  };
  if (*frame.result.cut != '\0') event(stream::EventKind::cut, frame.result.cut);
  if (frame.result.warning != warning_) {
    warning_ = frame.result.warning;
    if (!warning_.empty()) event(stream::EventKind::warning, warning_);
  }
  const bool other = state != state_;
  if (state == TrackState::kTracking) {
    if (other) {
      event(tracked_ ? stream::EventKind::found : stream::EventKind::started,
            tracked_ ? "relocalized" : "started");
    }
    tracked_ = true;
  } else if (state == TrackState::kLost) {
    if (other) event(stream::EventKind::lost, "lost: " + reason);
  } else if (other || reason != reason_) {
    event(stream::EventKind::waiting, reason);
  }
  state_ = state;
  reason_ = reason;
  if (events_.size() > kEventsKept) {
    events_.erase(events_.begin(), events_.begin() + static_cast<long>(kEventsKept / 2));
  }
}

std::string StreamEncoder::EncodeFrame(const StreamFrame& frame) {
  const TrackResult& result = frame.result;
  const Anchor hangs_on = Reanchored(
      told_.snapshot().state(), {frame.pose.reference, frame.pose.T_reference_camera.Inverse(), 1});
  const bool placed = frame.pose.tracked && hangs_on.keyframe.valid() &&
                      told_.keyframes().count(hangs_on.keyframe.value) != 0;
  Path::Entry entry{frame.number, result.state, {}, frame.time, {}};
  if (placed) {
    entry.reference = hangs_on.keyframe;
    entry.T_reference_camera = hangs_on.T_camera_keyframe.Inverse();
  }
  path_->Add(entry, static_cast<size_t>(settings_.path_frames));

  fb::FlatBufferBuilder builder(65536);
  const auto cut = builder.CreateString(result.cut);
  const auto ms = builder.CreateVector(frame.ms.data(), frame.ms.size());
  std::vector<uint8_t> features;
  features.reserve(6 * frame.features.size());
  for (const FeatureUse& feature : frame.features) PackFeature(feature, source_.camera, features);
  const auto packed = builder.CreateVector(features);
  std::vector<fb::Offset<stream::Detection>> detections;
  const bool stale = frame.detection_age > settings_.detection_seconds;
  for (const StreamBox& d : frame.detections) {
    if (stale) break;
    detections.push_back(stream::CreateDetectionDirect(builder, d.box.x, d.box.y, d.box.width,
                                                       d.box.height, d.score, d.label.c_str()));
  }
  const auto boxes = builder.CreateVector(detections);
  const auto outlines = EncodeOutlines(builder, frame.mover_mask, settings_.outline_tolerance);
  fb::Offset<stream::Picture> picture;
  if (!frame.picture.bytes.empty()) {
    const auto type = builder.CreateString(frame.picture.type);
    const auto bytes = builder.CreateVector(
        reinterpret_cast<const uint8_t*>(frame.picture.bytes.data()), frame.picture.bytes.size());
    picture = stream::CreatePicture(builder, static_cast<uint16_t>(frame.picture.width),
                                    static_cast<uint16_t>(frame.picture.height), type, bytes);
  }
  const MapSnapshot& map = told_.snapshot();
  const stream::Pose beside = PackPose(entry.T_reference_camera);
  const stream::Pose live = PackPose(result.predicted.value_or(result.T_world_camera));
  stream::FrameBuilder made(builder);
  made.add_number(frame.number);
  made.add_time(frame.time);
  made.add_state(static_cast<stream::State>(result.state));
  made.add_cut(cut);
  made.add_keyframe(result.keyframe);
  if (placed) {
    made.add_reference(entry.reference.value);
    made.add_map(told_.keyframes().at(entry.reference.value).map.value);
    made.add_t_reference_camera(&beside);
  }
  if (result.state == TrackState::kTracking || result.predicted) made.add_t_world_camera(&live);
  made.add_predicted(result.predicted.has_value());
  made.add_failure(static_cast<stream::Failure>(result.failure));
  made.add_keyframes(static_cast<uint32_t>(map.keyframe_count()));
  made.add_landmarks(static_cast<uint32_t>(map.landmark_count()));
  made.add_matches(static_cast<uint32_t>(result.matches));
  made.add_maps(maps_);
  made.add_found_share(static_cast<float>(result.quality.found_share));
  made.add_ms(ms);
  made.add_features(packed);
  made.add_detections(boxes);
  made.add_detection_age(static_cast<float>(frame.detection_age));
  made.add_outlines(outlines);
  if (!picture.IsNull()) made.add_picture(picture);
  return Finish(builder, made.Finish(), stream::Body::Frame);
}

void StreamEncoder::TellCamera(const Camera& camera, std::vector<std::string>& messages) {
  const auto lens = [](const Camera& c) { return std::tie(c.fx, c.fy, c.cx, c.cy, c.distortion); };
  if (camera.width == 0 || lens(camera) == lens(source_.camera)) return;
  source_.camera = camera;
  messages.push_back(Hello());
}

std::vector<std::string> StreamEncoder::Add(const StreamFrame& frame) {
  std::vector<std::string> messages;
  last_number_ = frame.number;
  last_time_ = frame.time;
  TellCamera(frame.camera, messages);
  TellMap(frame.map, frame.number, frame.time, messages);
  TellState(frame, messages);
  messages.push_back(EncodeFrame(frame));
  return messages;
}

std::vector<std::string> StreamEncoder::End(const MapSnapshot& map, const Camera& camera) {
  std::vector<std::string> messages;
  TellCamera(camera, messages);
  TellMap(map, last_number_, last_time_, messages);
  messages.push_back(
      EncodeEvent(stream::EventKind::finished, last_number_, last_time_, "finished"));
  events_.push_back(messages.back());
  return messages;
}

std::vector<std::string> StreamEncoder::Whole() const {
  std::vector<std::string> messages = {Hello()};
  MapNews all;
  for (const auto& [id, told] : told_.keyframes()) {
    all.keyframes.push_back({id});
    if (told.depth) all.depths.push_back({id});
  }
  for (const auto& [id, told] : told_.landmarks()) all.landmarks.push_back({id});
  std::sort(all.keyframes.begin(), all.keyframes.end());
  std::sort(all.depths.begin(), all.depths.end());
  std::sort(all.landmarks.begin(), all.landmarks.end());

  fb::FlatBufferBuilder builder(1 << 20);
  std::vector<fb::Offset<stream::KeyFrame>> keyframes;
  for (KeyFrameId id : all.keyframes)
    keyframes.push_back(EncodeKeyFrame(builder, id.value, told_.keyframes().at(id.value)));
  std::vector<uint8_t> landmarks;
  for (LandmarkId id : all.landmarks) PackLandmark(id, told_.landmarks().at(id.value), landmarks);
  std::vector<fb::Offset<stream::DepthCloud>> depths;
  for (KeyFrameId id : all.depths) {
    depths.push_back(EncodeDepth(builder, id.value, told_.keyframes().at(id.value).depth.get(),
                                 settings_.depth_points));
  }
  std::vector<stream::PathFrame> path;
  for (const Path::Entry& entry : path_->entries) {
    path.push_back({entry.number, static_cast<stream::State>(entry.state), entry.reference.value,
                    entry.time, PackPose(entry.T_reference_camera)});
  }
  const std::vector<stream::World> worlds = WorldsOf(told_.snapshot());
  const auto change =
      stream::CreateMapChangeDirect(builder, told_.snapshot().version(), true, &keyframes, nullptr,
                                    &landmarks, nullptr, nullptr, &depths, &path, true, &worlds);
  messages.push_back(Finish(builder, change, stream::Body::MapChange));
  messages.insert(messages.end(), events_.begin(), events_.end());
  return messages;
}

}  // namespace alidade
