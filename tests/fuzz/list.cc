#include <cmath>

#include "alidade/base/error.h"
#include "alidade/inertial/imu_stream.h"
#include "alidade/io/files/datasets/recording.h"
#include "alidade/io/files/datasets/stamped_list.h"
#include "alidade/io/imu_table.h"
#include "fuzz/targets.h"

namespace alidade::fuzz {
namespace {

// Frames of the whole list, each associated with an entry of the list within 0.02 s.
void Use(const std::vector<StampedName>& list) {
  std::vector<RecordedFrame> frames = FramesOf(list, "rgb");
  Expect(frames.size() == list.size(), "frames were lost or made up");
  size_t good = 0;
  for (size_t i = 0; i < frames.size(); ++i) {
    Expect(std::isfinite(frames[i].time), "a frame's time is not finite");
    Expect(i == 0 || frames[i - 1].part <= frames[i].part, "parts are not in order");
    Expect(i == 0 || frames[i - 1].part < frames[i].part || frames[i - 1].time <= frames[i].time,
           "frames are not in the order of time");
    good += frames[i].problem.empty() ? 1 : 0;
  }
  const int found = AttachByTime(frames, &RecordedFrame::depth, list, "depth", 0.02);
  Expect(found >= 0 && static_cast<size_t>(found) == good, "a frame was not found by its own time");
}

}  // namespace

void List(std::string_view bytes) {
  bool any = false;
  std::string problem;
  try {
    ImuStream stream;
    const auto samples = stream.Add(ParseImuTable(bytes, "imu.csv").samples);
    for (size_t i = 1; i < samples.size(); ++i)
      Expect(samples[i - 1].time < samples[i].time, "readings are not in order of time");
    stream.News();
    any = true;
  } catch (const Error&) {
  }
  for (const StampUnit unit : {StampUnit::kSeconds, StampUnit::kNanoseconds}) {
    for (const bool with_names : {true, false}) {
      try {
        const FindUnit find = with_names ? FindUnit::kYes : FindUnit::kNo;
        Use(ParseStampedList(bytes, "rgb.txt", unit, with_names, find));
        any = true;
      } catch (const Error& error) {
        problem = error.what();
      }
    }
  }
  if (!any) ThrowInput(problem);
}

}  // namespace alidade::fuzz
