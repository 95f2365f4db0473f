// The stream tells the unit of maps and gravity, when they become known.
#include <gtest/gtest.h>

#include "alidade/map/map_store.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/stream/stream_scene.h"
#include "problems/synthetic_map.h"

namespace alidade::stream_worlds_test {
namespace {

StreamScene Late(const StreamEncoder& encoder) {
  StreamScene scene;
  for (const std::string& message : encoder.Whole()) scene.Take(message);
  return scene;
}

TEST(StreamWorlds, TellsMetersAndGravityOnceTheyAreKnown) {
  MapStore store;
  FillMap(MakeSyntheticWorld({.points = 50, .cameras = 3}), {}, store);
  const MapId id{0};
  StreamEncoder encoder(
      {"test", "none", "mono", "map units", -1, false, Camera::FromFieldOfView(64, 48, 60), {}});
  StreamScene scene;
  scene.Take(encoder.Hello());
  StreamFrame frame;
  const auto tell = [&] {
    ++frame.number;
    frame.map = store.Snapshot();
    const std::vector<std::string> messages = encoder.Add(frame);
    for (const std::string& message : messages) scene.Take(message);
    EXPECT_EQ(scene.worlds, store.Snapshot().state().worlds);
    EXPECT_EQ(Late(encoder).worlds, scene.worlds);
    return messages.size();
  };
  tell();
  EXPECT_EQ(scene.UnitOf(id), "map units");
  store.Commit([&](MapCommit& commit) { commit.SetWorld({id, true, 0.02, {0, 0.6, 0.8}, 0.01}); });
  EXPECT_EQ(tell(), 2u);  // the change and the frame
  EXPECT_EQ(scene.UnitOf(id), "m");
  EXPECT_EQ(scene.UnitOf(MapId{1}), "map units");
  EXPECT_EQ(tell(), 1u);
  store.Commit([&](MapCommit& commit) { commit.ForgetWorld(id); });
  EXPECT_EQ(tell(), 2u);
  EXPECT_EQ(scene.UnitOf(id), "map units");
}

}  // namespace
}  // namespace alidade::stream_worlds_test
