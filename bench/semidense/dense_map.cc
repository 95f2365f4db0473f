#include "bench/semidense/dense_map.h"

#include <algorithm>
#include <iterator>

#include "alidade/map/depth_cloud.h"
#include "alidade/run/sources/any_source.h"
#include "alidade/slam.h"
#include "alidade/system/prepare.h"

namespace alidade::bench {
namespace {

// What is kept of a frame that is, or may yet become, a keyframe.
struct KeptFrame {
  int number = 0;  // of the call of Track()
  DenseKeyFrame pictures;
};

cv::Mat TruthOf(const SourceFrame& frame, const Camera& camera) {
  if (!frame.true_depth.empty() || frame.depth.empty()) return frame.true_depth;
  const double metres = frame.depth.type() == CV_16U ? 1 / camera.depth_factor : 1;
  cv::Mat truth;
  frame.depth.convertTo(truth, CV_32F, metres);
  return truth;
}

DenseKeyFrame Keep(const SourceFrame& frame, const Camera& given, const Camera& used,
                   const SlamSettings& settings) {
  const FrameInput prepared =
      Prepare({frame.time, frame.image, frame.right, frame.depth}, given, used, settings);
  const auto picture = std::make_shared<Picture>(Picture{prepared.image, {}, prepared.depth});
  return {KeyFrameId{}, picture, frame.image, TruthOf(frame, given)};
}

}  // namespace

DenseMap MakeDenseMap(const std::string& source, int count, const SlamSettings& settings) {
  SourceOptions options;
  options.last = count - 1;
  const auto opened = OpenAnySource(source, options);
  const Camera& given = opened->Info().camera;
  Slam slam(given, settings);
  DenseMap dense;
  dense.camera = slam.camera();
  dense.sensor = settings.sensor;
  dense.source = opened->Info().sensor;
  std::vector<KeptFrame> kept;
  bool waiting = false;  // frames are kept that may yet start a map
  while (const auto frame = opened->Next()) {
    if (!frame->problem.empty()) continue;
    const int number = dense.frames++;
    dense.rendered = !frame->true_depth.empty();
    const TrackResult result = slam.Track({frame->time, frame->image, frame->right, frame->depth});
    const bool starting = result.state == TrackState::kInitializing;
    if (result.keyframe || starting)
      kept.push_back({number, Keep(*frame, given, slam.camera(), settings)});
    if (starting) waiting = true;
    if (starting || !waiting) continue;
    const MapSnapshot map = slam.Snapshot();
    std::vector<int> numbers;
    for (KeyFrameId id : map.KeyFrames()) numbers.push_back(map.Find(id)->frame->number);
    std::erase_if(kept, [&](const KeptFrame& k) {
      return std::find(numbers.begin(), numbers.end(), k.number) == numbers.end();
    });
    waiting = false;
  }
  slam.Finish();
  for (const FramePose& pose : slam.Trajectory()) dense.tracked += pose.tracked;
  dense.map = slam.Snapshot();
  for (KeyFrameId id : dense.map.KeyFrames()) {
    const int number = dense.map.Find(id)->frame->number;
    const auto it = std::find_if(kept.begin(), kept.end(),
                                 [&](const KeptFrame& k) { return k.number == number; });
    if (it == kept.end() || it->pictures.truth.empty()) continue;
    dense.keyframes.push_back(it->pictures);
    dense.keyframes.back().id = id;
  }
  return dense;
}

DepthScores ScoreDense(const DenseMap& dense, const MapSnapshot& map) {
  DepthErrorSettings settings;
  settings.fit_scale = dense.sensor == Sensor::kMono;
  DepthScorer scorer(settings);
  const std::vector<MapId> maps = map.Maps();
  for (const DenseKeyFrame& of : dense.keyframes) {
    const KeyFrame& keyframe = *map.Find(of.id);
    cv::Mat estimate(dense.camera.height, dense.camera.width, CV_32F, cv::Scalar(0));
    if (keyframe.depth) {
      const double scale = PlaceDepth(keyframe).scale;
      DrawDepth(*keyframe.depth, scale, dense.camera)
          .convertTo(estimate, CV_32F, 1 / kDepthPictureFactor);
    }
    const auto which = std::find(maps.begin(), maps.end(), keyframe.map);
    scorer.Add(
        {estimate, of.truth, of.image, static_cast<int>(std::distance(maps.begin(), which))});
  }
  return scorer.Result().overall;
}

}  // namespace alidade::bench
