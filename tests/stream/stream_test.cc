// The stream reproduces the map, for a receiver of all messages and for one that joins late.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "alidade/base/error.h"
#include "alidade/slam.h"
#include "alidade/stream/pack.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/stream/stream_scene.h"
#include "support/rendered_frames.h"

namespace alidade::stream_test {
namespace {

constexpr int kBlack = -1;

std::vector<int> Steps(int first, int last, int step) {
  std::vector<int> numbers;
  for (int i = first; i <= last; i += step) numbers.push_back(i);
  return numbers;
}

SlamSettings Phone(bool threaded) {
  SlamSettings settings;
  settings.ApplyProfile("phone");
  settings.sensor = Sensor::kRgbd;
  settings.new_map_frames = 8;
  settings.threaded = threaded;
  settings.semidense.enabled = true;
  return settings;
}

RenderedFrames& Room() { return SmallRoom(); }

// A run with its stream and a receiver.
struct Streamed {
  explicit Streamed(const SlamSettings& settings)
      : slam(Room().camera(), settings),
        encoder({"test", "room", "rgbd", "m", -1, false, slam.camera(), {}}) {
    Read(encoder.Hello());
  }
  void Read(const std::string& message) {
    bytes += message.size();
    messages.push_back(message);
    scene.Take(message);
  }
  // `told_each`: only every n-th frame is passed to the stream.
  void Play(const std::vector<int>& numbers, int told_each = 1) {
    for (int number : numbers) {
      const RenderedFrame& frame = Room().Frame(std::max(number, 0));
      const auto shown = [&](const cv::Mat& image) {
        return number == kBlack ? cv::Mat(cv::Mat::zeros(image.size(), image.type())) : image;
      };
      StreamFrame told;
      told.number = played;
      told.time = 0.1 * played;
      told.result = slam.Track({told.time, shown(frame.image), {}, shown(frame.depth)});
      if (++played % told_each != 0) continue;
      told.map = slam.Snapshot();
      told.pose = slam.Trajectory(slam.frames() - 1).back();
      told.features = slam.Features();
      for (const std::string& message : encoder.Add(told)) Read(message);
    }
  }
  void Finish() {
    slam.Finish();
    for (const std::string& message : encoder.End(slam.Snapshot())) Read(message);
  }

  Slam slam;
  StreamEncoder encoder;
  StreamScene scene;
  std::vector<std::string> messages;
  size_t bytes = 0;
  int played = 0;
};

// Checks that the scene equals the map within the stream's resolution.
void ExpectMap(const StreamScene& scene, const MapSnapshot& map) {
  ASSERT_EQ(scene.keyframes.size(), static_cast<size_t>(map.keyframe_count()));
  ASSERT_EQ(scene.landmarks.size(), static_cast<size_t>(map.landmark_count()));
  for (const auto& [id, told] : scene.keyframes) {
    const KeyFrame* keyframe = map.Find(id);
    ASSERT_TRUE(keyframe);
    const Se3 T_world_camera = keyframe->T_camera_world.Inverse();
    EXPECT_LT((told.T_world_camera.t - T_world_camera.t).norm(), 1e-9);
    EXPECT_LT((told.T_world_camera.R - T_world_camera.R).norm(), 1e-9);
    EXPECT_EQ(told.scale, keyframe->scale);
    EXPECT_EQ(told.parent, keyframe->parent);
    EXPECT_EQ(told.map, keyframe->map);
    EXPECT_EQ(told.loops.size(), keyframe->loops.size());
    EXPECT_EQ(told.depth.empty(), !keyframe->depth || keyframe->depth->pixels.empty());
  }
  for (const auto& [id, told] : scene.landmarks) {
    const Landmark* landmark = map.Find(id);
    ASSERT_TRUE(landmark);
    const double distance = (landmark->p_world - map.Find(told.keyframe)->Centre()).norm();
    EXPECT_LT((scene.PointOf(told) - landmark->p_world).norm(), 1.1e-3 * distance);
  }
}

// Checks that the frames' poses equal the system's current estimates.
void ExpectPath(const StreamScene& scene, const Slam& slam) {
  const std::vector<FramePose> trajectory = slam.Trajectory();
  int compared = 0;
  for (const SceneFrame& frame : scene.path) {
    const FramePose& pose = trajectory.at(static_cast<size_t>(frame.number));
    EXPECT_EQ(frame.reference.valid(), pose.tracked) << frame.number;
    if (!frame.reference.valid() || !pose.tracked) continue;
    const Se3 error = scene.PoseOf(frame).Inverse() * pose.T_world_camera;
    EXPECT_LT(error.Log().norm(), 1e-6) << frame.number;
    ++compared;
  }
  EXPECT_GT(compared, 10);
}

// Checks that the last frame's camera pose equals the system's current estimate.
void ExpectNow(const StreamScene& scene, const Slam& slam) {
  EXPECT_EQ(scene.camera.fx, slam.camera().fx);
  EXPECT_EQ(scene.camera.cy, slam.camera().cy);
  EXPECT_EQ(scene.camera.height, slam.camera().height);
  const FramePose pose = slam.Trajectory().back();
  ASSERT_TRUE(pose.tracked);
  const std::optional<Se3> camera = scene.CameraPose();
  ASSERT_TRUE(camera);
  EXPECT_LT((camera->Inverse() * pose.T_world_camera).Log().norm(), 1e-6);
  ASSERT_TRUE(scene.now.T_world_camera);
  EXPECT_EQ(scene.now.number, scene.path.back().number);
  EXPECT_EQ(scene.ActiveMap(), scene.keyframes.at(scene.path.back().reference).map);
}

void ExpectSame(const StreamScene& a, const StreamScene& b) {
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  ASSERT_EQ(a.path.size(), b.path.size());
  ASSERT_EQ(a.events.size(), b.events.size());
  EXPECT_EQ(a.version, b.version);
  EXPECT_EQ(a.worlds, b.worlds);
  for (const auto& [id, one] : a.keyframes) {
    const SceneKeyFrame& other = b.keyframes.at(id);
    EXPECT_EQ(one.T_world_camera.t, other.T_world_camera.t);
    EXPECT_EQ(one.covisible, other.covisible);
    EXPECT_EQ(one.loops, other.loops);
    EXPECT_EQ(one.depth, other.depth);
  }
  for (const auto& [id, one] : a.landmarks) {
    EXPECT_EQ(one.keyframe, b.landmarks.at(id).keyframe);
    EXPECT_EQ(one.p, b.landmarks.at(id).p);
  }
  for (size_t i = 0; i < a.path.size(); ++i) {
    ASSERT_EQ(a.path[i].reference, b.path[i].reference);
    EXPECT_LT((a.path[i].T_reference_camera.t - b.path[i].T_reference_camera.t).norm(), 1e-9);
  }
}

StreamScene Late(const StreamEncoder& encoder) {
  StreamScene scene;
  for (const std::string& message : encoder.Whole()) scene.Take(message);
  return scene;
}

class StreamOfARun : public testing::TestWithParam<bool> {};

// Lost in the dark and relocalized; two maps are merged; keyframes are culled meanwhile.
TEST_P(StreamOfARun, GivesTheMapBack) {
  Streamed run(Phone(GetParam()));
  run.Play(Steps(0, 48, 3));
  if (!GetParam()) ExpectMap(run.scene, run.slam.Snapshot());
  ExpectNow(run.scene, run.slam);
  const uint64_t told = run.scene.told;
  run.Play({kBlack, kBlack, kBlack});
  EXPECT_FALSE(run.scene.CameraPose() && !run.scene.now.T_world_guess);
  run.Play(Steps(330, 480, 6));
  ExpectSame(run.scene, Late(run.encoder));
  EXPECT_GT(run.scene.told, told);
  EXPECT_NE(Late(run.encoder).told, Late(run.encoder).told);
  run.Play(Steps(486, 640, 6), 5);  // few frames are streamed
  run.Finish();
  ExpectMap(run.scene, run.slam.Snapshot());
  ExpectPath(run.scene, run.slam);
  ExpectSame(run.scene, Late(run.encoder));
  if (!GetParam()) {  // with threads the workers' progress is not determined
    EXPECT_EQ(run.slam.Counts().merges, 1);
    std::set<int> kinds;
    for (const SceneEvent& event : run.scene.events) kinds.insert(event.kind);
    for (stream::EventKind kind :
         {stream::EventKind::started, stream::EventKind::lost, stream::EventKind::new_map,
          stream::EventKind::merge, stream::EventKind::finished}) {
      EXPECT_EQ(kinds.count(static_cast<int>(kind)), 1u) << stream::EnumNameEventKind(kind);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Schedules, StreamOfARun, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Threaded" : "Inline"; });

TEST(Stream, OfALoadedMapTellsAllOfIt) {
  std::string saved;
  {
    Streamed first(Phone(false));
    first.Play(Steps(0, 48, 3));
    first.Finish();
    saved = first.slam.SaveMap();
  }
  Streamed second(Phone(false));
  second.slam.Load(DecodeMap(saved));
  second.Play(Steps(36, 48, 3));
  second.Finish();
  ExpectMap(second.scene, second.slam.Snapshot());
  ExpectSame(second.scene, Late(second.encoder));
}

TEST(Stream, ThinnedPathsKeepTheirEnds) {
  StreamSettings settings;
  settings.path_frames = 100;
  StreamEncoder encoder(
      {"test", "none", "mono", "map units", -1, false, Camera::FromFieldOfView(64, 48, 60), {}},
      settings);
  StreamFrame frame;
  for (frame.number = 0; frame.number < 1000; ++frame.number) encoder.Add(frame);
  const StreamScene late = Late(encoder);
  EXPECT_LE(late.path.size(), 100u);
  EXPECT_GE(late.path.size(), 50u);
  EXPECT_EQ(late.path.front().number, 0);
  EXPECT_EQ(late.path.back().number, 999);
}

TEST(Stream, ABetterKnownCameraIsToldOnceAndTheMapGoesOn) {
  Streamed run(Phone(false));
  run.Play(Steps(0, 24, 3));
  const size_t keyframes = run.scene.keyframes.size();
  ASSERT_GT(keyframes, 0u);
  StreamFrame frame;
  frame.number = run.played;
  frame.map = run.slam.Snapshot();
  frame.camera = run.slam.camera();
  for (const std::string& message : run.encoder.Add(frame)) run.Read(message);
  ++frame.number;
  // The camera and the map are unchanged: the frame alone.
  EXPECT_EQ(run.encoder.Add(frame).size(), 1u);
  frame.camera.fx *= 1.1;
  frame.camera.distortion[0] = -0.1;
  for (int i = 0; i < 2; ++i) {
    ++frame.number;
    const std::vector<std::string> messages = run.encoder.Add(frame);
    EXPECT_EQ(messages.size(), i == 0 ? 2u : 1u);
    for (const std::string& message : messages) run.Read(message);
  }
  EXPECT_EQ(run.scene.camera.fx, frame.camera.fx);
  EXPECT_EQ(run.scene.camera.distortion, frame.camera.distortion);
  EXPECT_EQ(run.scene.keyframes.size(), keyframes);
  EXPECT_EQ(Late(run.encoder).camera.fx, frame.camera.fx);
}

TEST(Stream, DamagedMessagesAreRefused) {
  Streamed run(Phone(false));
  run.Play(Steps(0, 24, 3));
  run.Finish();
  uint32_t seed = 1;
  const auto random = [&] { return seed = seed * 1664525u + 1013904223u, seed >> 8; };
  int refused = 0;
  for (const std::string& message : run.messages) {
    for (int turn = 0; turn < 40; ++turn) {
      std::string damaged = message;
      if (turn % 4 == 0) {
        damaged.resize(random() % damaged.size());
      } else {
        for (int i = 0; i < 1 + turn % 3; ++i)
          damaged[random() % damaged.size()] = static_cast<char>(random());
      }
      StreamScene scene;
      try {
        scene.Take(damaged);
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100);
}

// Features matched to a landmark of the last keyframes are marked as new, also when the keyframe
// made the landmark from features that the tracker had not matched.
TEST(Stream, TellsWhatBecameOfFeatures) {
  constexpr int kNew = 2;  // keyframes
  Streamed run(Phone(false));
  int keyframes = 0, others = 0;
  for (int number = 0; number <= 90; number += 2) {
    run.Play({number});
    if (run.slam.Trajectory().back().tracked == false) continue;
    const MapSnapshot map = run.slam.Snapshot();
    std::set<std::pair<int, int>> fresh;  // by position in 1/25 pixels
    const auto place = [](double x, double y) {
      return std::pair(static_cast<int>(std::lround(25 * x)),
                       static_cast<int>(std::lround(25 * y)));
    };
    int matched = 0;
    for (const SceneFeature& feature : run.scene.features) {
      if (feature.use == static_cast<int>(stream::Use::fresh))
        fresh.insert(place(feature.x, feature.y));
      matched += feature.use == static_cast<int>(stream::Use::matched);
    }
    const KeyFrame& newest = *map.Find(KeyFrameId{map.next_keyframe() - 1});
    if (newest.frame->number != run.played - 1) {
      if (keyframes <= kNew) continue;  // all are new
      ++others;
      EXPECT_GT(matched, 0);
      continue;
    }
    ++keyframes;
    int young = 0;
    for (size_t k = 0; k < newest.landmarks.size(); ++k) {
      const Landmark* landmark = map.Find(newest.landmarks[k]);
      if (!landmark || static_cast<int>(newest.id.value - landmark->born.value) >= kNew) continue;
      ++young;
      const Keypoint& keypoint = newest.frame->keypoints[k];
      EXPECT_EQ(fresh.count(place(UnpackPlace(PackPlace(keypoint.raw_x, run.slam.camera().width),
                                              run.slam.camera().width),
                                  UnpackPlace(PackPlace(keypoint.raw_y, run.slam.camera().height),
                                              run.slam.camera().height))),
                1u);
    }
    EXPECT_GE(young, 20);  // a keyframe is made only if it adds landmarks
    if (keyframes > kNew) {
      EXPECT_GT(matched, 0);
    }
  }
  EXPECT_GE(keyframes, 5);
  EXPECT_GE(others, 5);
}

TEST(Stream, TellsWhatWasFoundAndLeftOut) {
  StreamSettings settings;
  settings.detection_seconds = 0.5;
  StreamEncoder encoder(
      {"test", "none", "mono", "map units", -1, false, Camera::FromFieldOfView(640, 480, 60), {}},
      settings);
  StreamScene scene;
  scene.Take(encoder.Hello());
  StreamFrame frame;
  const auto show = [&] {
    for (const std::string& message : encoder.Add(frame)) scene.Take(message);
    ++frame.number;
  };
  show();
  EXPECT_LT(scene.detection_age, 0);
  EXPECT_TRUE(scene.boxes.empty());
  frame.detections = {{{10, 20, 100, 200}, 0.75f, "person"}};
  frame.detection_age = 0.25;
  frame.mover_mask = cv::Mat::zeros(480, 640, CV_8U);
  frame.mover_mask(cv::Rect(50, 60, 80, 90)) = 255;
  show();
  ASSERT_EQ(scene.boxes.size(), 1u);
  EXPECT_EQ(scene.boxes[0].x, 10);
  EXPECT_EQ(scene.boxes[0].height, 200);
  EXPECT_EQ(scene.boxes[0].score, 0.75f);
  EXPECT_EQ(scene.boxes[0].label, "person");
  EXPECT_EQ(scene.detection_age, 0.25f);
  EXPECT_EQ(scene.outlines, 1);
  frame.detection_age = 0.6;  // people have moved on
  show();
  EXPECT_TRUE(scene.boxes.empty());
  EXPECT_EQ(scene.detection_age, 0.6f);
}

TEST(Packing, KeepsPlacesAndDepthsToTheirSteps) {
  for (double x : {0.0, 0.25, 17.7, 639.0})
    EXPECT_NEAR(UnpackPlace(PackPlace(x, 640), 640), x, 0.5 * 640 / 65536 + 1e-9);
  DepthMap depth{640, 480, 2, {}};
  depth.pixels.push_back({10, 20, 0.5f, 0.01f, {255, 128, 0}});
  depth.pixels.push_back({639, 479, 1.7f, 0.01f, {0, 0, 255}});
  depth.pixels.push_back({300, 200, 0.051f, 0.01f, {10, 20, 30}});
  const PackedCloud cloud = PackCloud(depth, 100);
  ASSERT_EQ(cloud.bytes.size(), 3 * kPackedPoint);
  for (size_t i = 0; i < 3; ++i) {
    const DepthPixel& pixel = depth.pixels[i];
    const CloudPoint point =
        UnpackPoint(reinterpret_cast<const uint8_t*>(cloud.bytes.data()) + i * kPackedPoint,
                    cloud.least, cloud.most, 640, 480);
    EXPECT_NEAR(point.x, pixel.x, 0.01);
    EXPECT_NEAR(point.y, pixel.y, 0.01);
    EXPECT_NEAR(point.inverse_depth, 2 * pixel.inverse_depth, 1e-4 * pixel.inverse_depth);
    EXPECT_NEAR(point.red, pixel.rgb[0], 8);
    EXPECT_NEAR(point.green, pixel.rgb[1], 4);
    EXPECT_NEAR(point.blue, pixel.rgb[2], 8);
  }
  EXPECT_EQ(PackCloud(depth, 2).bytes.size(), 2 * kPackedPoint);
  EXPECT_TRUE(PackCloud({}, 100).bytes.empty());
}

}  // namespace
}  // namespace alidade::stream_test
