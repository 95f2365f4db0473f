#include "fuzz/use_bag.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "alidade/base/error.h"
#include "alidade/io/ros/camera_info.h"
#include "alidade/io/ros/messages/foxglove_calibration.h"
#include "alidade/io/ros/messages/picture_of_message.h"
#include "alidade/io/ros/messages/video_message.h"
#include "alidade/io/ros/source/choose_topics.h"
#include "alidade/io/ros/source/imu_topics.h"
#include "alidade/io/ros/source/topic_stamps.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {
namespace {

constexpr size_t kMostUsed = 20;  // messages per topic; limits the time spent decoding

void UseCameraInfo(const RosCameraInfo& info) {
  for (const bool rectified : {false, true}) {
    const auto camera = CameraOfInfo(info, rectified);
    if (!camera) continue;
    Expect(camera->fx > 0 && camera->fy > 0, "a focal length that is not positive");
    for (const double k : camera->distortion) Expect(std::isfinite(k), "a lens that is not finite");
    Calibration calibration;
    calibration.left = *camera;
    if (AddRightCamera(info, info, rectified, calibration))
      Expect(calibration.baseline > 0 || calibration.right, "a pair without a baseline");
  }
}

void UsePicture(std::string_view message, Serialization serialization, bool compressed) {
  const RosPicture picture = ParseRosPicture(message, serialization, compressed);
  // OpenCV's other formats are not tested here.
  if (compressed && !LooksLikeJpeg(picture.data) && !LooksLikePng(picture.data) &&
      picture.encoding.find("compressedDepth") == std::string::npos)
    ThrowInput("neither JPEG nor PNG");
  bool any = false;
  std::string problem;
  for (const ImageUse use : {ImageUse::kGray, ImageUse::kGrayAndColor, ImageUse::kDepth}) {
    try {
      const DecodedImage decoded = PictureOf(picture, use);
      Expect(!decoded.image.empty(), "an empty picture");
      const int type = decoded.image.type();
      Expect(type == CV_16UC1 || type == (use == ImageUse::kDepth ? CV_32FC1 : CV_8UC1),
             "of another type");
      any = true;
    } catch (const Error& error) {
      problem = error.what();
    }
  }
  if (!any) ThrowInput(problem);
}

// Decoding is FFmpeg's, and not tested here.
void UseVideo(std::string_view message, Serialization serialization) {
  const RosPicture picture = ParseVideo(message, serialization);
  const bool is_keyframe = IsKeyframe(CodecOfFormat(picture.encoding), picture.data);
  Expect(!is_keyframe || picture.data.size() > 3, "a keyframe without bytes");
  try {
    const int64_t stamp = ParseVideoHeader(message, serialization).stamp;
    Expect(stamp == picture.header.stamp, "two stamps of one message");
  } catch (const Error&) {
    Expect(false, "a message with a header that cannot be read");
  }
}

}  // namespace

void UseMessage(std::string_view message, Serialization serialization) {
  bool any = false;
  std::string problem;
  for (int type = 0; type < 5; ++type) {
    try {
      if (type == 0) {
        UseCameraInfo(ParseRosCameraInfo(message, serialization));
      } else if (type == 3) {
        UseVideo(message, serialization);
      } else if (type == 4) {
        UseCameraInfo(ParseFoxgloveCalibration(message, serialization));
      } else {
        UsePicture(message, serialization, type == 1);
      }
      any = true;
    } catch (const Error& error) {
      problem = error.what();
    }
  }
  if (!any) ThrowInput(problem);
}

void CheckReadings(const std::vector<ImuSample>& samples) {
  for (size_t i = 0; i < samples.size(); ++i) {
    Expect(samples[i].angular_rate.allFinite() && samples[i].specific_force.allFinite(),
           "a reading is not finite");
    Expect(i == 0 || samples[i - 1].time < samples[i].time, "readings are not in order of time");
  }
}

void UseBag(BagFile& bag, size_t size) {
  std::string bytes;
  for (size_t topic = 0; topic < bag.Topics().size(); ++topic) {
    const std::vector<BagMessage>& messages = bag.Messages(topic);
    Expect(messages.size() <= size, "more messages than bytes");
    Expect(std::is_sorted(
               messages.begin(), messages.end(),
               [](const BagMessage& a, const BagMessage& b) { return a.log_time < b.log_time; }),
           "messages are not in the order of time");
    for (size_t i = 0; i < std::min(messages.size(), kMostUsed); ++i) {
      if (!bag.Read(messages[i], bytes).empty()) continue;
      try {
        UseMessage(bytes, bag.Topics()[topic].serialization);
      } catch (const Error&) {  // other messages may be valid
      }
    }
  }
  const BagQuery query = {"file", {}, {}, {}, {}, {}, {}, {}};
  const ChosenTopics chosen = ChooseTopics(bag, query, {});
  if (const BagImu imu = ReadBagImu(bag, query, chosen.image); imu.recording)
    CheckReadings(imu.recording->samples);
  TopicStamps frames(bag, chosen.image.topic);
  PartnerFinder finder(frames, frames, 0.02);
  for (size_t i = 0; i < std::min(frames.size(), kMostUsed); ++i) {
    StampText(frames.Stamp(i));
    finder.PartnerOf(i);
  }
  const auto rate = frames.Rate();
  Expect(!rate || (std::isfinite(*rate) && *rate > 0), "a rate that cannot be");
}

}  // namespace alidade::fuzz
