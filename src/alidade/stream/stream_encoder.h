// The stream's one encoder: shown each frame's result and the map, it gives messages (stream.fbs).
// What it is not shown it does not know; it changes nothing. One thread at a time.
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

// What is streamed.
struct StreamSource {
  std::string program, source, sensor;  // "alidade 0.1.0"; as typed; "mono", "stereo" or "rgbd"
  std::string unit;                     // "m" or "map units"
  int frames = -1;                      // of the recording; -1: unknown
  bool live = false;                    // a camera
  Camera camera;
  std::vector<StreamTruth> truth;                                    // empty: unknown
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();  // see SourceInfo
};

struct StreamPlayback {
  bool paused = false, finished = false, may_pause = false;
};

class StreamEncoder {
 public:
  // Throws Error (usage) on settings that cannot be.
  explicit StreamEncoder(StreamSource source, const StreamSettings& settings = {});
  ~StreamEncoder();
  StreamEncoder(const StreamEncoder&) = delete;
  StreamEncoder& operator=(const StreamEncoder&) = delete;

  // Known later than the rest: to be told by another Hello().
  void SetTruth(std::vector<StreamTruth> truth) { source_.truth = std::move(truth); }

  // Each a message.
  std::string Hello() const;
  std::string Playback(const StreamPlayback& playback) const;

  // The messages of one more frame, in order: another Hello() when its camera is another, what the
  // map has other than before, events, the frame. Frames may be left out, the next one's messages
  // make up for them.
  std::vector<std::string> Add(const StreamFrame& frame);
  // When nothing will follow: the map as it was finished, and the camera (as StreamFrame's).
  std::vector<std::string> End(const MapSnapshot& map, const Camera& camera = {});

  // For those who join now: hello and all that was told, as one map change that begins anew. What
  // Add() gives next goes on from it.
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
  std::string reason_;  // why there was no pose, told last
  std::string warning_;
  bool tracked_ = false;             // ever
  std::vector<std::string> events_;  // so far, for those who join late
  uint32_t maps_ = 0;                // as told
  int last_number_ = 0;
  double last_time_ = 0;
};

}  // namespace alidade
