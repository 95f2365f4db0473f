// Small crafted files with a valid checksum that would exhaust memory or cause endless loops.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "alidade/map/map_generated.h"
#include "support/expect_error.h"
#include "support/map_bytes.h"
#include "support/saved_map.h"

namespace alidade::map_hostile_test {
namespace {

using flatbuffers::FlatBufferBuilder;

// Contents of a map file; each test corrupts one part.
struct Parts {
  int width = 640, height = 480;
  uint32_t next_keyframe = 1000, next_landmark = 1000, next_map = 1;
  std::vector<flatbuffers::Offset<fb::Setting>> settings;
  std::vector<flatbuffers::Offset<fb::KeyFrame>> keyframes;
  std::vector<flatbuffers::Offset<fb::Landmark>> landmarks;
  flatbuffers::Offset<fb::Places> places;
};

std::string Bytes(FlatBufferBuilder& builder, const Parts& parts) {
  const std::vector<double> distortion(5, 0.0);
  const auto camera = fb::CreateCameraDirect(builder, parts.width, parts.height, 500, 500, 320, 240,
                                             &distortion, 30, 5000, 0);
  const fb::Checksum unknown(0);
  fb::FinishMapBuffer(
      builder, fb::CreateMapDirect(builder, 2, &unknown, "rgbd", camera, &parts.settings,
                                   parts.next_keyframe, parts.next_landmark, &parts.keyframes,
                                   &parts.landmarks, parts.next_map, parts.places));
  std::string bytes(reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize());
  EXPECT_TRUE(RepairChecksum(bytes));
  return bytes;
}

std::string Complaint(FlatBufferBuilder& builder, const Parts& parts) {
  const std::string bytes = Bytes(builder, parts);
  return MessageOf(ErrorKind::kInput, [&] { DecodeMap(bytes); });
}

const fb::Vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1), kZero(0, 0, 0);
const fb::Pose kIdentity(kX, kY, kZ, kZero);

flatbuffers::Offset<fb::KeyFrame> AddKeyFrame(FlatBufferBuilder& builder, uint32_t id,
                                              size_t keypoints = 1) {
  const std::vector<fb::Keypoint> points(keypoints, fb::Keypoint(9, 9, 9, 9, 0, 1, -1, -1, 0));
  const std::vector<fb::Descriptor> descriptors(keypoints, fb::Descriptor(1, 2, 3, 4));
  return fb::CreateKeyFrameDirect(builder, id, id == 0 ? KeyFrameId::kNone : id - 1,
                                  static_cast<int>(id), 0.1 * id, &kIdentity, &points,
                                  &descriptors);
}

TEST(HostileMap, PartsAreGoodUnlessSpoiled) {
  FlatBufferBuilder builder;
  Parts parts;
  for (uint32_t id = 0; id < 3; ++id) parts.keyframes.push_back(AddKeyFrame(builder, id));
  parts.settings.push_back(fb::CreateSettingDirect(builder, "seed", "1"));
  const SavedMap read = DecodeMap(Bytes(builder, parts));
  EXPECT_EQ(read.map.keyframe_count(), 3);
  EXPECT_EQ(read.map.MapOf({2}), MapId{0});
}

TEST(HostileMap, OneLongSettingManyTimes) {
  FlatBufferBuilder builder;
  Parts parts;
  const auto once = fb::CreateSettingDirect(builder, "seed", std::string(1 << 20, '1').c_str());
  parts.settings.assign(100000, once);  // 100 GB
  EXPECT_THAT(Complaint(builder, parts), testing::HasSubstr("larger than the file"));
}

TEST(HostileMap, KeyframesThatShareTheirLists) {
  FlatBufferBuilder builder;
  Parts parts;
  const std::vector<fb::Keypoint> points(2000, fb::Keypoint(9, 9, 9, 9, 0, 1, -1, -1, 0));
  const std::vector<fb::Descriptor> codes(2000, fb::Descriptor(1, 2, 3, 4));
  const std::vector<fb::Neighbour> neighbours(2000, fb::Neighbour(1, 20));
  const auto keypoints = builder.CreateVectorOfStructs(points);
  const auto descriptors = builder.CreateVectorOfStructs(codes);
  const auto covisible = builder.CreateVectorOfStructs(neighbours);
  for (uint32_t id = 0; id < 900; ++id) {
    parts.keyframes.push_back(fb::CreateKeyFrame(builder, id, id == 0 ? KeyFrameId::kNone : id - 1,
                                                 0, 0, &kIdentity, keypoints, descriptors,
                                                 covisible));
  }
  EXPECT_THAT(Complaint(builder, parts), testing::HasSubstr("larger than the file"));
}

TEST(HostileMap, OneKeyframeManyTimes) {
  FlatBufferBuilder builder;
  Parts parts;
  parts.keyframes.assign(2, AddKeyFrame(builder, 0));
  EXPECT_THAT(Complaint(builder, parts), testing::HasSubstr("one id"));
}

TEST(HostileMap, IdsWithoutObjects) {
  FlatBufferBuilder builder;
  Parts parts;
  parts.next_landmark = parts.next_keyframe =
      // Large ids, as in a map of long operation.
      0xfffffff0;
  parts.keyframes = {AddKeyFrame(builder, 0)};
  const SavedMap read = DecodeMap(Bytes(builder, parts));
  EXPECT_EQ(read.map.keyframe_count(), 1);
  EXPECT_EQ(read.map.next_keyframe(), 0xfffffff0u);
  FlatBufferBuilder second;
  parts.keyframes = {AddKeyFrame(second, 0)};
  parts.next_keyframe = parts.next_map = 0;
  EXPECT_THAT(Complaint(second, parts), testing::HasSubstr("never assigned"));
  FlatBufferBuilder third;
  parts.keyframes.clear();
  parts.next_keyframe = 10;
  parts.next_map = 11;
  EXPECT_THAT(Complaint(third, parts), testing::HasSubstr("more maps than keyframes"));
}

TEST(HostileMap, LargeImagesOfTinyKeyframes) {
  FlatBufferBuilder builder;
  Parts parts;
  parts.width = 8192;
  parts.height = 8192;
  for (uint32_t id = 0; id < 900; ++id) parts.keyframes.push_back(AddKeyFrame(builder, id));
  EXPECT_THAT(Complaint(builder, parts), testing::HasSubstr("too large for so many keyframes"));
}

TEST(HostileMap, VocabularyThatIsNoTree) {
  const fb::Descriptor centre(0, 0, 0, 0);
  const std::vector<std::vector<fb::PlaceNode>> cases = {
      {{centre, 0, 2}, {centre, 0, 0}, {centre, 0, 0}},           // its own child
      {{centre, 1, 0xffffffff}, {centre, 0, 0}, {centre, 0, 0}},  // more children than nodes
      {{centre, 1, 2}, {centre, 1, 2}, {centre, 0, 0}}};          // a cycle
  for (const auto& nodes : cases) {
    FlatBufferBuilder builder;
    Parts parts;
    parts.places = fb::CreatePlaces(builder, builder.CreateVectorOfStructs(nodes), 3);
    EXPECT_THAT(Complaint(builder, parts), testing::HasSubstr("vocabulary"));
  }
}

}  // namespace
}  // namespace alidade::map_hostile_test
