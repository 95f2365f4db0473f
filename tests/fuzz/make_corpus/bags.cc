#include "bags.h"

#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>

#include "alidade/io/files/image_codec.h"
#include "bags/bag_bytes.h"
#include "bags/message_bytes.h"
#include "support/temp_folder.h"

namespace alidade {
namespace {

cv::Mat Slope(int type) {
  cv::Mat image(6, 8, type);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      if (type == CV_8UC1) image.at<uchar>(y, x) = static_cast<uchar>(30 * x + y);
      if (type == CV_16UC1) image.at<uint16_t>(y, x) = static_cast<uint16_t>(1000 + 10 * x + y);
    }
  return image;
}

InfoFields SmallInfo() {
  InfoFields info;
  info.width = 8;
  info.height = 6;
  info.K = {7, 0, 4, 0, 7, 3, 0, 0, 1};
  info.P = {7, 0, 4, 0, 0, 7, 3, 0, 0, 0, 1, 0};
  return info;
}

std::vector<WrittenMessage> SmallMessages(Dialect dialect) {
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < 2; ++i) {
    const int64_t stamp = 1'000'000'000 + 33'000'000 * i;
    messages.push_back({"/cam/image_raw", "sensor_msgs/Image", stamp,
                        ImageMessage(dialect, stamp, "c", "mono8", Slope(CV_8UC1))});
    messages.push_back({"/cam/depth/compressedDepth", "sensor_msgs/CompressedImage", stamp,
                        CompressedMessage(dialect, stamp, "c", "16UC1; compressedDepth png",
                                          std::string(12, '\0') + EncodePng(Slope(CV_16UC1)))});
    messages.push_back({"/cam/camera_info", "sensor_msgs/CameraInfo", stamp,
                        InfoMessage(dialect, stamp, SmallInfo())});
  }
  return messages;
}

void WriteMessages(const WriteCorpusFile& write) {
  for (const bool cdr : {false, true}) {
    const Dialect dialect{cdr};
    const std::string start = cdr ? "c" : "1", end = cdr ? "-cdr" : "-ros1";
    InfoFields rational = SmallInfo();
    rational.model = "rational_polynomial";
    rational.D = {0.1, -0.01, 0, 0, 0, 0.1, 0, 0};
    write("ros_message", "good-info" + end, start + InfoMessage(dialect, 5, SmallInfo()));
    write("ros_message", "good-rational" + end, start + InfoMessage(dialect, 5, rational));
    for (const char* encoding : {"mono8", "bayer_rggb8"})
      write("ros_message", std::string("good-") + encoding + end,
            start + ImageMessage(dialect, 5, "c", encoding, Slope(CV_8UC1)));
    write("ros_message", "good-depth" + end,
          start + ImageMessage(dialect, 5, "c", "16UC1", Slope(CV_16UC1)));
    write("ros_message", "good-png" + end,
          start + CompressedMessage(dialect, 5, "c", "png", EncodePng(Slope(CV_8UC1))));
    const std::vector<std::pair<const char*, int>> several = {
        {"rgb8", 3}, {"bgra8", 4}, {"yuv422", 2}, {"32FC1", 4}};
    for (const auto& [encoding, bytes] : several)
      write("ros_message", std::string("good-") + encoding + end,
            start + ImageMessage(dialect, 5, "c", encoding, {8, 6},
                                 std::string(static_cast<size_t>(48 * bytes), 'a')));
  }
  write("ros_message", "bad-short", "1abc");
}

}  // namespace

void WriteBags(const WriteCorpusFile& write) {
  for (const std::string packing : {"none", "bz2", "lz4"}) {
    write("bag", "good-" + packing,
          BagBytes({packing, true, true, 4, false}).Of(SmallMessages({false})));
    write("bag", "good-never-closed-" + packing,
          BagBytes({packing, false, true, 4, false}).Of(SmallMessages({false})));
  }
  write("bag", "bad-start", "#ROSBAG V2.0\n");
  for (const std::string packing : {"none", "lz4", "zstd"}) {
    write("mcap", "good-" + packing, McapBytes({packing}, false).Of(SmallMessages({true})));
    write("mcap", "good-never-closed-" + packing,
          McapBytes({packing, false}, false).Of(SmallMessages({true})));
  }
  write("mcap", "good-without-chunks",
        McapBytes({"none", true, false}, false).Of(SmallMessages({true})));
  write("mcap", "good-ros1", McapBytes({"zstd"}, true).Of(SmallMessages({false})));
  write("mcap", "bad-start", "\x89MCAP0\r\n");
  const TempFolder folder;
  for (const std::string packing : {"none", "zstd"}) {
    const std::string path = folder / (packing + ".db3");
    WriteDatabase(path, SmallMessages({true}), packing);
    std::ifstream file(path, std::ios::binary);
    write("database", "good-" + packing, {std::istreambuf_iterator<char>(file), {}});
  }
  write("database", "bad-start", "SQLite format 3");
  WriteMessages(write);
}

}  // namespace alidade
