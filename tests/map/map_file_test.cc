#include "alidade/map/map_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "support/check_map.h"
#include "support/expect_error.h"
#include "support/synthetic_map.h"

namespace alidade {
namespace {

// A map with everything that can be in one: culled keyframes and landmarks, forwarded ids, depth
// and clutter.
SavedMap SomeMap() {
  const SyntheticWorld world = MakeSyntheticWorld({.points = 200,
                                                   .cameras = 9,
                                                   .noise_px = 1,
                                                   .flipped_bits = 10,
                                                   .clutter = 20,
                                                   .depth = true});
  MapStore store;
  const SyntheticMap made = FillMap(world, {.pose_sigma = 0.01, .point_sigma = 0.02}, store);
  SavedMap saved;
  saved.map = store.Commit([&](MapCommit& commit) {
    std::vector<LandmarkId> ids;
    for (uint32_t i = 0; i < commit.next_landmark(); ++i) ids.push_back({i});
    commit.Remove(ids[7]);
    commit.Replace(ids[20], ids[21]);
    commit.Replace(ids[21], ids[22]);  // a chain
    commit.Replace(ids[30], ids[31]);
    commit.Remove(ids[31]);  // leads nowhere
    commit.Remove(made.keyframes[3]);
    commit.Remove(made.keyframes[4]);
    for (LandmarkId id : ids) commit.RefreshLandmark(id);
  });
  ExpectConsistent(saved.map);
  saved.camera = world.camera;
  saved.camera.distortion = {0.1, -0.05, 0.001, 0.002, 0.01};
  saved.sensor = "rgbd";
  saved.settings = {{"seed", "1"}, {"tracker.extractor.features", "1000"}};
  return saved;
}

bool SamePose(const Se3& a, const Se3& b) { return a.R == b.R && a.t == b.t; }  // to the last bit

TEST(MapFile, ReadsBackWhatWasWritten) {
  const SavedMap saved = SomeMap();
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.sensor, saved.sensor);
  EXPECT_EQ(read.settings, saved.settings);
  EXPECT_EQ(read.camera.width, saved.camera.width);
  EXPECT_EQ(read.camera.fx, saved.camera.fx);
  EXPECT_EQ(read.camera.cy, saved.camera.cy);
  EXPECT_EQ(read.camera.distortion, saved.camera.distortion);
  EXPECT_EQ(read.camera.depth_factor, saved.camera.depth_factor);

  ExpectConsistent(read.map);
  EXPECT_EQ(read.map.next_keyframe(), saved.map.next_keyframe());
  EXPECT_EQ(read.map.next_landmark(), saved.map.next_landmark());
  ASSERT_EQ(read.map.KeyFrames(), saved.map.KeyFrames());
  ASSERT_EQ(read.map.Landmarks(), saved.map.Landmarks());
  for (uint32_t i = 0; i < saved.map.next_keyframe(); ++i) {
    EXPECT_TRUE(SamePose(read.map.PoseOf({i}), saved.map.PoseOf({i}))) << i;
  }
  for (KeyFrameId id : saved.map.KeyFrames()) {
    const KeyFrame &a = *saved.map.Find(id), &b = *read.map.Find(id);
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.landmarks, b.landmarks);
    EXPECT_EQ(a.frame->time, b.frame->time);
    EXPECT_EQ(a.frame->number, b.frame->number);
    EXPECT_EQ(a.frame->descriptors, b.frame->descriptors);
    ASSERT_EQ(a.frame->keypoints.size(), b.frame->keypoints.size());
    EXPECT_EQ(std::memcmp(a.frame->keypoints.data(), b.frame->keypoints.data(),
                          a.frame->keypoints.size() * sizeof(Keypoint)),
              0);
    ASSERT_EQ(a.covisible.size(), b.covisible.size());
    for (size_t i = 0; i < a.covisible.size(); ++i) {
      EXPECT_EQ(a.covisible[i].id, b.covisible[i].id);
      EXPECT_EQ(a.covisible[i].shared, b.covisible[i].shared);
    }
    int near = 0;  // the search grid was made again
    const Keypoint& first = b.frame->keypoints.front();
    b.frame->grid.VisitNear(first.x, first.y, 1, [&](int k) { near += k == 0; });
    EXPECT_EQ(near, 1);
  }
  for (LandmarkId id : saved.map.Landmarks()) {
    const Landmark &a = *saved.map.Find(id), &b = *read.map.Find(id);
    EXPECT_EQ(a.p_world, b.p_world);
    EXPECT_EQ(a.reference, b.reference);
    EXPECT_EQ(a.born, b.born);
    EXPECT_EQ(a.descriptor, b.descriptor);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.min_distance, b.min_distance);
    EXPECT_EQ(a.max_distance, b.max_distance);
    ASSERT_EQ(a.observations.size(), b.observations.size());
  }
  for (uint32_t i = 0; i < saved.map.next_landmark(); ++i) {
    EXPECT_EQ(read.map.Current({i}), saved.map.Current({i})) << i;
  }
}

TEST(MapFile, WrittenAgainHasTheSameBytes) {
  const std::string bytes = EncodeMap(SomeMap());
  EXPECT_TRUE(EncodeMap(DecodeMap(bytes)) == bytes);
  EXPECT_EQ(bytes.substr(4, 4), "ALDM");  // what any FlatBuffers reader looks for
}

TEST(MapFile, EqualMapsWithDifferentHistoriesHaveTheSameBytes) {
  const SavedMap saved = SomeMap();
  SavedMap later = saved;
  MapStore store;
  store.Restore(saved.map);
  for (int i = 0; i < 3; ++i) {
    later.map =
        store.Commit([&](MapCommit& commit) { commit.Edit(KeyFrameId{0})->T_camera_world.t *= 1; });
  }
  ASSERT_NE(later.map.version(), saved.map.version());
  EXPECT_TRUE(EncodeMap(later) == EncodeMap(saved));
}

TEST(MapFile, TheMapGoesOnAfterReading) {
  const SavedMap read = DecodeMap(EncodeMap(SomeMap()));
  MapStore store;
  store.Restore(read.map);
  const KeyFrameId last = read.map.KeyFrames().back();
  store.Commit([&](MapCommit& commit) {
    KeyFrame keyframe;
    keyframe.frame = commit.Find(last)->frame;
    keyframe.parent = last;
    EXPECT_EQ(commit.Add(std::move(keyframe)).value, read.map.next_keyframe());
    commit.Remove(read.map.Landmarks().front());
    commit.Remove(last);
    for (LandmarkId id : read.map.Landmarks()) commit.RefreshLandmark(id);
  });
  ExpectConsistent(store.Snapshot());
}

TEST(MapFile, AnEmptyMapIsAMap) {
  SavedMap saved;
  saved.camera = Camera::FromFieldOfView(640, 480, 66);
  saved.sensor = "mono";
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.map.keyframe_count(), 0);
  EXPECT_TRUE(read.settings.empty());
}

TEST(MapFile, ReadsBytesThatLieAtAnyAddress) {
  const std::string bytes = EncodeMap(SomeMap());
  std::string shifted = "x" + bytes;
  EXPECT_EQ(DecodeMap(std::string_view(shifted).substr(1)).map.keyframe_count(), 7);
}

TEST(MapFile, RefusesWhatIsNoMap) {
  const auto decode = [](std::string_view bytes) { return [bytes] { DecodeMap(bytes); }; };
  for (const char* bytes : {"", "ALDM", "not a map but a text that goes on for a while"}) {
    EXPECT_THAT(MessageOf(ErrorKind::kInput, decode(bytes)), testing::HasSubstr("not a map"));
  }
}

TEST(MapFile, RefusesATruncatedMap) {
  const std::string bytes = EncodeMap(SomeMap());
  for (size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97) {
    MessageOf(ErrorKind::kInput, [&] { DecodeMap(std::string_view(bytes).substr(0, size)); });
  }
}

TEST(MapFile, NoticesAnyDamagedByte) {
  const std::string bytes = EncodeMap(SomeMap());
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    std::string damaged = bytes;
    damaged[random.Below(static_cast<uint32_t>(bytes.size()))] ^=
        static_cast<char>(1 << random.Below(8));
    MessageOf(ErrorKind::kInput, [&] { DecodeMap(damaged); });
  }
}

// Maps that contradict themselves, with a checksum that fits: only made on purpose.
TEST(MapFile, RefusesAMapThatContradictsItself) {
  struct Case {
    const char* message;
    void (*spoil)(MapCommit&);
  };
  const Case cases[] = {
      {"no rigid motion", [](MapCommit& c) { c.Edit(KeyFrameId{1})->T_camera_world.R *= 1.1; }},
      {"no rigid motion", [](MapCommit& c) { c.Edit(KeyFrameId{1})->T_camera_world.t.x() = NAN; }},
      {"parent", [](MapCommit& c) { c.Edit(KeyFrameId{1})->parent = {2}; }},
      {"parent", [](MapCommit& c) { c.Edit(KeyFrameId{1})->parent = {1}; }},
      {"neighbour", [](MapCommit& c) { c.Edit(KeyFrameId{1})->covisible[0].id = {77}; }},
      {"not a number", [](MapCommit& c) { c.Edit(LandmarkId{0})->p_world.y() = NAN; }},
      {"reference", [](MapCommit& c) { c.Edit(LandmarkId{0})->reference = {77}; }},
      {"reference", [](MapCommit& c) { c.Edit(LandmarkId{0})->observations.clear(); }},
      {"never was", [](MapCommit& c) { c.Edit(LandmarkId{0})->born = {77}; }},
      {"what is not there",
       [](MapCommit& c) { c.Edit(LandmarkId{0})->observations[0].keypoint = 100000; }},
      {"what is not there",
       [](MapCommit& c) { c.Edit(LandmarkId{0})->observations[0].keyframe = {77}; }},
      {"out of order",
       [](MapCommit& c) {
         auto& seen = c.Edit(LandmarkId{0})->observations;
         std::swap(seen[0], seen[1]);
       }},
      {"two landmarks",
       [](MapCommit& c) {
         c.Edit(LandmarkId{1})->observations = c.Find(LandmarkId{0})->observations;
         c.Edit(LandmarkId{1})->reference = c.Find(LandmarkId{0})->reference;
       }},
  };
  for (const Case& spoiled : cases) {
    SavedMap saved = SomeMap();
    MapStore store;
    store.Restore(saved.map);
    saved.map = store.Commit(spoiled.spoil);
    EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { DecodeMap(EncodeMap(saved)); }),
                testing::HasSubstr(spoiled.message));
  }
  SavedMap saved = SomeMap();
  saved.sensor = "sonar";
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { DecodeMap(EncodeMap(saved)); }),
              testing::HasSubstr("sensor"));
  saved = SomeMap();
  saved.camera.fx = -1;
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { DecodeMap(EncodeMap(saved)); }),
              testing::HasSubstr("fx"));
}

}  // namespace
}  // namespace alidade
