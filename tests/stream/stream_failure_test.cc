// Why a frame has no pose, as the stream reports it.
#include <gtest/gtest.h>

#include "alidade/slam.h"
#include "alidade/stream/stream_encoder.h"
#include "alidade/stream/stream_generated.h"
#include "alidade/stream/stream_scene.h"
#include "support/rendered_frames.h"

namespace alidade::stream_failure_test {
namespace {

std::string FrameOfVersion01(const char* reason) {
  flatbuffers::FlatBufferBuilder builder;
  const auto words = builder.CreateString(reason);
  stream::FrameBuilder frame(builder);
  frame.add_state(stream::State::lost);
  frame.add_reason(words);
  builder.Finish(stream::CreateMessage(builder, stream::Body::Frame, frame.Finish().Union()),
                 stream::MessageIdentifier());
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

TEST(StreamFailure, OfVersion01IsInWords) {
  StreamScene scene;
  scene.Take(FrameOfVersion01("the camera hardly moves"));
  EXPECT_EQ(scene.now.reason, "the camera hardly moves");
  EXPECT_EQ(scene.now.failure, TrackFailure::kNone);
}

TEST(StreamFailure, IsNamedAsInTheLibrary) {
  EXPECT_EQ(static_cast<int>(stream::Failure::MAX) + 1, kTrackFailures);
  for (int i = 1; i < kTrackFailures; ++i) {
    EXPECT_STREQ(stream::EnumNameFailure(static_cast<stream::Failure>(i)),
                 FailureName(static_cast<TrackFailure>(i)));
  }
}

TEST(StreamFailure, IsThatOfTheFrame) {
  SlamSettings settings;
  settings.sensor = Sensor::kMono;
  Slam slam(SmallRoom().camera(), settings);
  StreamEncoder encoder({"test", "room", "mono", "map units", -1, false, slam.camera(), {}});
  StreamScene scene;
  scene.Take(encoder.Hello());
  StreamFrame told;
  const cv::Mat black =
      cv::Mat::zeros(SmallRoom().camera().height, SmallRoom().camera().width, CV_8U);
  told.result = slam.Track({0, black, {}, {}});
  ASSERT_EQ(told.result.failure, TrackFailure::kFewCorners);
  told.map = slam.Snapshot();
  for (const std::string& message : encoder.Add(told)) scene.Take(message);
  EXPECT_EQ(scene.now.failure, TrackFailure::kFewCorners);
  EXPECT_EQ(scene.now.reason, told.result.reason());
}

}  // namespace
}  // namespace alidade::stream_failure_test
