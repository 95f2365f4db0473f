// Encodes each frame's result and the map as messages (stream.fbs). Has no effect on the SLAM
// system. Use from one thread at a time.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "alidade/stream/settings.h"
#include "alidade/stream/stream_frame.h"
#include "alidade/stream/told_map.h"

namespace alidade {

struct StreamTruth {
  double time = 0;  // seconds
  Se3 T_world_camera;
};

// Description of the run, sent in Hello.
struct StreamSource {
  std::string program, source, sensor;  // "alidade 0.2.0"; as typed; "mono", "stereo" or "rgbd"
  std::string unit;                     // "m" or "map units"
  int frames = -1;                      // of the recording; -1: unknown
  bool live = false;                    // a live camera
  Camera camera;
  std::vector<StreamTruth> truth;                                    // empty: unknown
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();  // see SourceInfo
};

struct StreamPlayback {
  bool paused = false, finished = false, may_pause = false;
};

class StreamEncoder {
 public:
  // Throws Error (usage) for invalid settings.
  explicit StreamEncoder(StreamSource source, const StreamSettings& settings = {});
  ~StreamEncoder();
  StreamEncoder(const StreamEncoder&) = delete;
  StreamEncoder& operator=(const StreamEncoder&) = delete;

  // For ground truth that becomes known later; takes effect with the next Hello().
  void SetTruth(std::vector<StreamTruth> truth) { source_.truth = std::move(truth); }

  // Each returns one message.
  std::string Hello() const;
  std::string Playback(const StreamPlayback& playback) const;

  // Messages for one more frame, in order: a Hello if the camera changed, the map's changes,
  // events, the frame. Frames may be skipped; the messages of the next one include their changes.
  std::vector<std::string> Add(const StreamFrame& frame);
  // Messages at the end of the run: the final map, and the camera as in StreamFrame.
  std::vector<std::string> End(const MapSnapshot& map, const Camera& camera = {});

  // Messages for a viewer that joins now: hello and the whole state, as one map change that
  // replaces everything. Later messages of Add() continue from there.
  std::vector<std::string> Whole() const;

 private:
  struct Path;
  struct Build;
  std::string EncodeFrame(const StreamFrame& frame);
  std::string EncodeNews(const MapNews& news) const;
  void TellCamera(const Camera& camera, std::vector<std::string>& messages);
  void TellMap(const MapSnapshot& map, int number, double time, std::vector<std::string>& messages);
  void TellState(const StreamFrame& frame, std::vector<std::string>& messages);

  StreamSource source_;
  StreamSettings settings_;
  ToldMap told_;
  std::unique_ptr<Path> path_;
  std::optional<TrackState> state_;
  std::string reason_;  // last reason for a missing pose that was sent
  std::string warning_;
  bool tracked_ = false;             // true once any frame was tracked
  std::vector<std::string> events_;  // so far, for viewers that join later
  uint32_t maps_ = 0;                // number of maps, as last sent
  int last_number_ = 0;
  double last_time_ = 0;
};

}  // namespace alidade
