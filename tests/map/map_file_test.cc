#include "alidade/map/map_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

#include "support/check_map.h"
#include "support/expect_error.h"
#include "support/map_bytes.h"
#include "support/saved_map.h"

namespace alidade::map_file_test {
namespace {

bool SamePose(const Se3& a, const Se3& b) { return a.R == b.R && a.t == b.t; }  // bitwise

TEST(MapFile, ReadsBackWhatWasWritten) {
  const SavedMap saved = MakeSavedMap();
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.sensor, saved.sensor);
  EXPECT_EQ(read.settings, saved.settings);
  EXPECT_EQ(read.camera.width, saved.camera.width);
  EXPECT_EQ(read.camera.fx, saved.camera.fx);
  EXPECT_EQ(read.camera.cy, saved.camera.cy);
  EXPECT_EQ(read.camera.distortion, saved.camera.distortion);
  EXPECT_EQ(read.camera.depth_factor, saved.camera.depth_factor);

  ASSERT_EQ(read.places.nodes.size(), saved.places.nodes.size());
  for (size_t i = 0; i < read.places.nodes.size(); ++i) {
    EXPECT_EQ(read.places.nodes[i].centre, saved.places.nodes[i].centre);
    EXPECT_EQ(read.places.nodes[i].first_child, saved.places.nodes[i].first_child);
    EXPECT_EQ(read.places.nodes[i].children, saved.places.nodes[i].children);
  }
  EXPECT_EQ(read.places.grown_at, saved.places.grown_at);

  ExpectConsistent(read.map);
  EXPECT_EQ(read.map.Maps(), (std::vector<MapId>{{0}, {1}}));
  EXPECT_EQ(read.map.state().next_map, 2u);
  EXPECT_EQ(read.map.next_keyframe(), saved.map.next_keyframe());
  EXPECT_EQ(read.map.next_landmark(), saved.map.next_landmark());
  ASSERT_EQ(read.map.KeyFrames(), saved.map.KeyFrames());
  ASSERT_EQ(read.map.Landmarks(), saved.map.Landmarks());
  EXPECT_GT(saved.map.state().culled.size(), 0);  // culled keyframes are not saved
  EXPECT_EQ(read.map.state().culled.size(), 0);
  EXPECT_FALSE(saved.map.state().forwards.empty());
  EXPECT_TRUE(read.map.state().forwards.empty());
  for (KeyFrameId id : saved.map.KeyFrames()) {
    const KeyFrame &a = *saved.map.Find(id), &b = *read.map.Find(id);
    EXPECT_TRUE(SamePose(a.T_camera_world, b.T_camera_world));
    EXPECT_EQ(a.parent, b.parent);
    EXPECT_EQ(a.map, b.map);
    EXPECT_EQ(a.scale, b.scale);
    EXPECT_EQ(a.loops, b.loops);
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
    int near = 0;  // the search grid was rebuilt
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
}

// A loaded map continues as the saved one would.
TEST(MapFile, KeepsWhatIsKnownOfTheDepthOfLandmarks) {
  SavedMap saved = MakeSavedMap();
  const std::string as_in_older_files = EncodeMap(saved);  // a field is absent at its default
  MapStore store;
  store.Restore(saved.map);
  const std::vector<LandmarkId> ids = saved.map.Landmarks();
  saved.map = store.Commit([&](MapCommit& commit) {
    commit.Edit(ids[3])->scale_known = false;
    commit.Edit(ids[5])->scale_known = false;
    commit.Edit(ids[5])->depth_assumed = true;
  });
  const std::string bytes = EncodeMap(saved);
  EXPECT_GT(bytes.size(), as_in_older_files.size());
  const SavedMap read = DecodeMap(bytes), old = DecodeMap(as_in_older_files);
  for (LandmarkId id : ids) {
    EXPECT_EQ(read.map.Find(id)->scale_known, id != ids[3] && id != ids[5]);
    EXPECT_EQ(read.map.Find(id)->depth_assumed, id == ids[5]);
    EXPECT_TRUE(old.map.Find(id)->scale_known);
    EXPECT_FALSE(old.map.Find(id)->depth_assumed);
  }
  EXPECT_TRUE(EncodeMap(read) == bytes);
}

// An invalid landmark must not prevent saving the map.
TEST(MapFile, ALandmarkThatIsNoNumberIsLeftOut) {
  SavedMap saved = MakeSavedMap();
  MapStore store;
  store.Restore(saved.map);
  const std::vector<LandmarkId> ids = saved.map.Landmarks();
  saved.map = store.Commit([&](MapCommit& commit) {
    commit.Edit(ids[3])->p_world.y() = std::numeric_limits<double>::quiet_NaN();
    commit.Edit(ids[5])->p_world.x() = 1e13;
    commit.Edit(ids[6])->normal.x() = 2;
  });
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.map.landmark_count(), static_cast<int>(ids.size()) - 3);
  EXPECT_EQ(read.map.Find(ids[3]), nullptr);
  ExpectConsistent(read.map);
}

// As after weeks of operation: few objects exist for the number of ids issued.
TEST(MapFile, AMapOfManyIdsLoads) {
  SavedMap saved = MakeSavedMap();
  MapState state = saved.map.state();
  state.next_keyframe = state.next_landmark = 0xfffffff0u;
  saved.map = MapSnapshot(std::make_shared<const MapState>(std::move(state)));
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.map.next_landmark(), 0xfffffff0u);
  EXPECT_EQ(read.map.Landmarks(), saved.map.Landmarks());
}

TEST(MapFile, WrittenAgainHasTheSameBytes) {
  const std::string bytes = EncodeMap(MakeSavedMap());
  EXPECT_TRUE(EncodeMap(DecodeMap(bytes)) == bytes);
  EXPECT_EQ(bytes.substr(4, 4), "ALDM");  // FlatBuffers file identifier
}

TEST(MapFile, EqualMapsWithDifferentHistoriesHaveTheSameBytes) {
  const SavedMap saved = MakeSavedMap();
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
  const SavedMap read = DecodeMap(EncodeMap(MakeSavedMap()));
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
  saved.camera.readout = {0, 0.02};
  saved.sensor = "mono";
  const SavedMap read = DecodeMap(EncodeMap(saved));
  EXPECT_EQ(read.camera.readout, (std::array{0.0, 0.02}));
  EXPECT_EQ(read.map.keyframe_count(), 0);
  EXPECT_TRUE(read.settings.empty());
}

TEST(MapFile, ReadsBytesThatLieAtAnyAddress) {
  const std::string bytes = EncodeMap(MakeSavedMap());
  std::string shifted = "x" + bytes;
  EXPECT_EQ(DecodeMap(std::string_view(shifted).substr(1)).map.keyframe_count(), 7 + 4);
}

TEST(MapFile, RefusesWhatIsNoMap) {
  const auto decode = [](std::string_view bytes) { return [bytes] { DecodeMap(bytes); }; };
  for (const char* bytes : {"", "ALDM", "not a map but a text that goes on for a while"}) {
    EXPECT_THAT(MessageOf(ErrorKind::kInput, decode(bytes)), testing::HasSubstr("not a map"));
  }
}

// Truncated and damaged files: map_fuzz_test.cc.

TEST(MapFile, RefusesAMapFromANewerProgram) {
  std::string bytes = EncodeMap(MakeSavedMap());
  SetMapVersion(bytes, 3);
  ASSERT_TRUE(RepairChecksum(bytes));
  const std::string message = MessageOf(ErrorKind::kInput, [&] { DecodeMap(bytes); });
  EXPECT_THAT(message, testing::HasSubstr("version 3"));
  EXPECT_THAT(message, testing::HasSubstr("newer"));
}

// Version 1 had one map and no loops, scales or places.
TEST(MapFile, ReadsVersionOne) {
  SavedMap saved = MakeSavedMap({.second_map = false, .loops = false, .places = false});
  std::string bytes = EncodeMap(saved);
  SetMapVersion(bytes, 1);
  ASSERT_TRUE(RepairChecksum(bytes));
  const SavedMap read = DecodeMap(bytes);
  EXPECT_EQ(read.version, 1u);
  EXPECT_EQ(read.map.KeyFrames(), saved.map.KeyFrames());
  EXPECT_EQ(read.map.Maps(), (std::vector<MapId>{{0}}));
  EXPECT_TRUE(EncodeMap(read) == EncodeMap(saved));  // the new encoding has version 2
}

// Reason why EncodeMap() refuses a map that DecodeMap() would reject.
std::string WhyNotWritten(const SavedMap& saved) {
  try {
    EncodeMap(saved);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "written";
}

// EncodeMap() applies the checks of DecodeMap(), so that every written file can be read.
TEST(MapFile, RefusesAMapThatContradictsItself) {
  struct Case {
    const char* message;
    void (*spoil)(MapCommit&);
  };
  const Case cases[] = {
      {"not a rigid motion", [](MapCommit& c) { c.Edit(KeyFrameId{1})->T_camera_world.R *= 1.1; }},
      {"not a number", [](MapCommit& c) { c.Edit(KeyFrameId{1})->T_camera_world.t.x() = NAN; }},
      {"far away", [](MapCommit& c) { c.Edit(KeyFrameId{1})->T_camera_world.t.x() = 1e13; }},
      {"another map", [](MapCommit& c) { c.Edit(KeyFrameId{1})->map = {1}; }},
      {"never existed", [](MapCommit& c) { c.Edit(KeyFrameId{1})->map = {2}; }},
      {"two first", [](MapCommit& c) { c.Edit(KeyFrameId{1})->parent = {}; }},
      {"scale", [](MapCommit& c) { c.Edit(KeyFrameId{1})->scale = 0; }},
      {"scale", [](MapCommit& c) { c.Edit(KeyFrameId{1})->scale = NAN; }},
      {"loop", [](MapCommit& c) { c.Edit(KeyFrameId{0})->loops = {{1}}; }},
      {"loop", [](MapCommit& c) { c.Edit(KeyFrameId{0})->loops = {{77}}; }},
      // The other keyframe still refers to it.
      {"loop", [](MapCommit& c) { c.Edit(KeyFrameId{0})->loops = {}; }},
      {"order",
       [](MapCommit& c) {
         c.Edit(KeyFrameId{0})->loops = {{8}, {8}};
       }},
      {"parent", [](MapCommit& c) { c.Edit(KeyFrameId{1})->parent = {2}; }},
      {"parent", [](MapCommit& c) { c.Edit(KeyFrameId{1})->parent = {1}; }},
      {"neighbor", [](MapCommit& c) { c.Edit(KeyFrameId{1})->covisible[0].id = {77}; }},
      {"reference", [](MapCommit& c) { c.Edit(LandmarkId{0})->reference = {77}; }},
      {"reference", [](MapCommit& c) { c.Edit(LandmarkId{0})->observations.clear(); }},
      {"never existed", [](MapCommit& c) { c.Edit(LandmarkId{0})->born = {77}; }},
      {"that does not exist",
       [](MapCommit& c) { c.Edit(LandmarkId{0})->observations[0].keypoint = 100000; }},
      {"that does not exist",
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
    SavedMap saved = MakeSavedMap();
    MapStore store;
    store.Restore(saved.map);
    saved.map = store.Commit(spoiled.spoil);
    EXPECT_THAT(WhyNotWritten(saved), testing::HasSubstr(spoiled.message));
  }
  SavedMap saved = MakeSavedMap();
  saved.sensor = "sonar";
  EXPECT_THAT(WhyNotWritten(saved), testing::HasSubstr("sensor"));
  saved = MakeSavedMap();
  saved.places.nodes.back().first_child = 1;
  EXPECT_THAT(WhyNotWritten(saved), testing::HasSubstr("vocabulary"));
  saved = MakeSavedMap();
  saved.places.grown_at = 0;
  EXPECT_THAT(WhyNotWritten(saved), testing::HasSubstr("vocabulary"));
  saved = MakeSavedMap();
  saved.camera.width = 1 << 20;
  EXPECT_THAT(WhyNotWritten(saved), testing::HasSubstr("too large"));
  saved = MakeSavedMap();
  saved.camera.fx = -1;
  EXPECT_THAT(WhyNotWritten(saved), testing::HasSubstr("fx"));
}

}  // namespace
}  // namespace alidade::map_file_test
