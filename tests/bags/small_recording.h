// A recording of five small frames with depth, as messages.
#pragma once

#include <functional>
#include <iterator>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "alidade/io/files/image_codec.h"
#include "bags/bag_bytes.h"
#include "bags/message_bytes.h"
#include "support/temp_folder.h"
#include "support/tiny_recording.h"

namespace alidade {

constexpr int64_t kStart = 1403715273'262142976;  // nanoseconds
constexpr int64_t kGap = 50'000'000;
constexpr int kSmallFrames = 5;

inline int64_t StampOf(int frame) { return kStart + kGap * frame; }

// Losslessly compressed images and raw depth; depth is recorded 30 ms late.
inline std::vector<WrittenMessage> SmallRecording(Dialect dialect) {
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < kSmallFrames; ++i) {
    const int64_t stamp = StampOf(i), log = stamp + 5'000'000;
    messages.push_back({"/imu", "sensor_msgs/Imu", log, "not looked at"});
    messages.push_back({"/camera/rgb/image_raw/compressed", "sensor_msgs/CompressedImage", log,
                        CompressedMessage(dialect, stamp, "camera", "mono8; png compressed ",
                                          EncodePng(TinyImage(i)))});
    messages.push_back({"/camera/rgb/camera_info", "sensor_msgs/CameraInfo", log,
                        InfoMessage(dialect, stamp, {})});
    messages.push_back({"/camera/depth/image_raw", "sensor_msgs/Image", log + 30'000'000,
                        ImageMessage(dialect, stamp, "camera", "16UC1", TinyDepth(i))});
  }
  return messages;
}

inline std::string ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Every container in every form: its name, and a function that writes it into a folder and returns
// its path.
struct Container {
  std::string name;
  std::function<std::string(const TempFolder&)> write;
};

// Names for parameterized tests; the default would print addresses.
inline void PrintTo(const Container& container, std::ostream* out) { *out << container.name; }

inline std::vector<Container> AllContainers() {
  const auto bag = [](BagForm form) {
    return [form](const TempFolder& folder) {
      return folder.Write("walk.bag", BagBytes(form).Of(SmallRecording({false})));
    };
  };
  const auto mcap = [](BagForm form, Dialect dialect = {true}) {
    return [form, dialect](const TempFolder& folder) {
      return folder.Write("walk.mcap", McapBytes(form, !dialect.cdr).Of(SmallRecording(dialect)));
    };
  };
  const auto database = [](const std::string& packing) {
    return [packing](const TempFolder& folder) {
      WriteDatabase(folder / "walk.db3", SmallRecording({true}), packing);
      return folder / "walk.db3";
    };
  };
  return {
      {"Bag", bag({"none"})},
      {"BagBz2", bag({"bz2"})},
      {"BagLz4", bag({"lz4"})},
      {"BagNeverClosed", bag({"none", false})},
      {"BagLz4NeverClosed", bag({"lz4", false})},
      {"Mcap", mcap({"none"})},
      {"McapLz4", mcap({"lz4"})},
      {"McapZstd", mcap({"zstd"})},
      {"McapWithoutChunks", mcap({"none", true, false})},
      {"McapWithoutFooter", mcap({"none", false})},
      {"McapZstdWithoutFooter", mcap({"zstd", false})},
      {"McapOfRos1", mcap({"zstd"}, {false})},
      {"McapBigEndian", mcap({"none"}, {true, true})},
      {"Database", database("")},
      {"DatabasePackedByMessage", database("zstd")},
      {"FolderOfDatabases",
       [](const TempFolder& folder) {
         const auto all = SmallRecording({true});
         folder.Write("walk/metadata.yaml", "rosbag2_bagfile_information:\n");
         const std::vector<WrittenMessage> first(all.begin(), all.begin() + 8);
         WriteDatabase(folder / "walk/walk_2.db3", first);
         WriteDatabase(folder / "walk/walk_10.db3", {all.begin() + 8, all.end()});
         return folder / "walk";
       }},
      {"FolderOfPackedFiles",
       [](const TempFolder& folder) {
         WriteDatabase(folder / "plain.db3", SmallRecording({true}));
         folder.Write("walk/walk_0.db3.zstd", Packed("zstd", ReadBytes(folder / "plain.db3")));
         return folder / "walk";
       }},
  };
}

}  // namespace alidade
