// A fixture that plays frames of the small room, with depth, into a Slam of phone size, in both
// schedules.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "alidade/slam.h"
#include "support/rendered_frames.h"

namespace alidade {

class RoomWithDepth : public testing::TestWithParam<bool> {  // threaded
 protected:
  // Frames are 1/15 s apart, whatever their numbers are.
  TrackResult Track(int number) {
    const RenderedFrame& frame = SmallRoom().Frame(number);
    return TrackNext(frame.image, frame.depth);
  }
  TrackResult TrackNext(const cv::Mat& image, const cv::Mat& depth) {
    time_ += 1 / 15.0;
    return slam_.Track({time_, image, {}, depth});
  }

  Slam slam_{SmallRoom().camera(), Settings()};

 private:
  static SlamSettings Settings() {
    SlamSettings settings;
    settings.ApplyProfile("phone");
    settings.sensor = Sensor::kRgbd;
    settings.threaded = GetParam();
    return settings;
  }
  double time_ = 0;
};

inline std::string ScheduleName(const testing::TestParamInfo<bool>& test) {
  return test.param ? "Threaded" : "Inline";
}

}  // namespace alidade
