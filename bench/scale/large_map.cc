#include "bench/scale/large_map.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "alidade/base/random.h"
#include "alidade/base/timing.h"
#include "alidade/map/map_file.h"
#include "alidade/place/place_index.h"
#include "alidade/tracking/tracker.h"

namespace alidade::bench {
namespace {

constexpr int kSeen = 1000, kNew = 100;  // landmarks a keyframe sees, and those it is the first to
constexpr double kStep = 0.1;            // metres between keyframes
constexpr double kNoise = 0.5;           // pixels
constexpr int kTurns = 20;

Camera CameraOfTheWay() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.depth_factor = 5000;
  return camera;
}

// The way goes along x, the cameras look along z; landmark j comes into view with keyframe
// j / kNew - 9.
struct Point {
  Eigen::Vector3d p_world;
  Descriptor descriptor;
};

Point PointOf(int j) {
  Random random(7, static_cast<uint64_t>(j));
  Point point;
  const double along = (j - kSeen / 2) * kStep / kNew;
  const double up = 2.4 * random.Uniform() - 1.2;
  const double away = 2.6 + 1.4 * random.Uniform();
  point.p_world = {along, up, away};
  for (uint64_t& word : point.descriptor.words) {
    const uint64_t high = random.Below(0xffffffff);
    word = high << 32 | random.Below(0xffffffff);
  }
  return point;
}

Se3 PoseAt(double keyframe) { return {Eigen::Matrix3d::Identity(), {-kStep * keyframe, 0, 0}}; }

// What a camera at `where` (in keyframes from the start) sees of `points`.
std::shared_ptr<Frame> FrameAt(double where, const std::vector<Point>& points, int number) {
  const Camera camera = CameraOfTheWay();
  Random random(11, static_cast<uint64_t>(number));
  auto frame = std::make_shared<Frame>();
  frame->number = number;
  frame->time = number / 30.0;
  for (const Point& point : points) {
    const Eigen::Vector3d p = PoseAt(where) * point.p_world;
    const double noise_x = random.Gaussian();
    const double noise_y = random.Gaussian();
    const Eigen::Vector2d pixel = camera.Project(p) + kNoise * Eigen::Vector2d(noise_x, noise_y);
    Keypoint keypoint;
    keypoint.x = keypoint.raw_x = static_cast<float>(pixel.x());
    keypoint.y = keypoint.raw_y = static_cast<float>(pixel.y());
    keypoint.depth = static_cast<float>(p.z());
    keypoint.right_x = static_cast<float>(pixel.x() - camera.bf() / p.z());
    Descriptor descriptor = point.descriptor;
    for (int flip = 0; flip < 12; ++flip) {
      const uint32_t bit = random.Below(256);
      descriptor.words[bit / 64] ^= uint64_t{1} << bit % 64;
    }
    frame->keypoints.push_back(keypoint);
    frame->descriptors.push_back(descriptor);
  }
  frame->grid = KeypointGrid(frame->keypoints, camera.width, camera.height);
  return frame;
}

std::vector<Point> PointsFrom(int first, int count) {
  std::vector<Point> points;
  for (int j = first; j < first + count; ++j) points.push_back(PointOf(j));
  return points;
}

// Enters a keyframe and the landmarks it is the first to see.
KeyFrameId Enter(MapStore& store, int i, std::vector<LandmarkId>& landmarks, KeyFrameId parent) {
  const std::vector<Point> points = PointsFrom(kNew * i, kSeen);
  KeyFrame keyframe;
  keyframe.frame = FrameAt(i, points, i);
  keyframe.T_camera_world = PoseAt(i);
  keyframe.parent = parent;
  KeyFrameId id;
  store.Commit([&](MapCommit& commit) {
    id = commit.Add(std::move(keyframe));
    for (int k = 0; k < kSeen; ++k) {
      const auto j = static_cast<size_t>(kNew * i + k);
      if (j < landmarks.size()) {
        commit.AddObservation(landmarks[j], id, k);
        continue;
      }
      Landmark landmark;
      landmark.p_world = points[static_cast<size_t>(k)].p_world;
      landmark.reference = landmark.born = id;
      landmark.observations = {{id, k}};
      landmarks.push_back(commit.Add(std::move(landmark)));
      commit.RefreshLandmark(landmarks.back());
    }
    commit.RefreshCovisibility(id);
  });
  return id;
}

template <typename Do>
std::vector<double> Timed(int turns, Do&& work) {
  std::vector<double> milliseconds;
  for (int turn = 0; turn < turns; ++turn) {
    const Stopwatch watch;
    work(turn);
    milliseconds.push_back(watch.Milliseconds());
  }
  return milliseconds;
}

}  // namespace

Section BenchLargeMap(int keyframes) {
  Section section;
  const std::string size = std::to_string(keyframes) + " keyframes";
  section.name = "a map of " + size;
  const auto add = [&](const std::string& name, std::vector<double> milliseconds,
                       const std::string& note = "") {
    section.timings.push_back({{size + ", " + name}, std::move(milliseconds), note});
  };
  const Camera camera = CameraOfTheWay();
  MapStore store;
  PlaceIndex places;
  std::vector<LandmarkId> landmarks;
  KeyFrameId last;
  const Stopwatch making;
  for (int i = 0; i < keyframes; ++i) {
    last = Enter(store, i, landmarks, last);
    places.Add(last, store.Snapshot().Find(last)->frame);
    if ((i + 1) % 1000 == 0) std::fprintf(stderr, "%d of %d keyframes\n", i + 1, keyframes);
  }
  const MapSnapshot map = store.Snapshot();
  add("one entered, and into the places", {making.Milliseconds() / keyframes},
      std::to_string(map.landmark_count()) + " landmarks alive");
  add("snapshot", Timed(kTurns, [&](int) { store.Snapshot(); }));
  add("commit, one landmark moved", Timed(kTurns, [&](int turn) {
        store.Commit([&](MapCommit& commit) {
          commit.Edit(landmarks[landmarks.size() / kTurns * static_cast<size_t>(turn)])
              ->p_world.x() += 0;
        });
      }));
  add("all keyframes listed", Timed(kTurns, [&](int) { map.KeyFrames(); }));

  SavedMap saved{store.Snapshot(), camera, "rgbd", {}, places.Save()};
  std::string bytes;
  const std::vector<double> saving = Timed(1, [&](int) { bytes = EncodeMap(saved); });
  add("saved, and read again for proof", saving, std::to_string(bytes.size() / 1000000) + " MB");
  SavedMap read;
  add("loaded", Timed(1, [&](int) { read = DecodeMap(bytes); }));
  PlaceIndex found;
  add("its places", Timed(1, [&](int) {
        std::vector<PlaceKeyFrame> frames;
        for (KeyFrameId id : read.map.KeyFrames()) frames.push_back({id, read.map.Find(id)->frame});
        found.Restore(read.places, frames);
      }));
  // Frames between keyframes, all along the way.
  int right = 0;
  Tracker tracker(camera, {});
  const std::vector<double> placing = Timed(kTurns, [&](int turn) {
    const double where = (keyframes - 12.0) * (turn + 0.5) / kTurns;
    const auto frame =
        FrameAt(where, PointsFrom(static_cast<int>(kNew * where), kSeen), keyframes + turn);
    std::vector<KeyFrameId> candidates;
    for (const PlaceMatch& match : found.Query(*frame, {}, 5)) candidates.push_back(match.id);
    const TrackEstimate placed = tracker.Relocalise(frame, read.map, candidates);
    const double off =
        (placed.placed.T_camera_world.Inverse().t - PoseAt(where).Inverse().t).norm();
    right += placed.tracked && off < 0.02;
  });
  add("a frame looked up and placed", placing,
      std::to_string(right) + " of " + std::to_string(kTurns) + " within 2 cm");
  return section;
}

}  // namespace alidade::bench
