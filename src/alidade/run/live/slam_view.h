// Shows a Slam that is fed frames in web browsers and records it, as `alidade run --viewer` and
// `--record` do a run. Changes no result.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/system/slam.h"

namespace ALIDADE_API alidade {

struct SlamViewOptions {
  std::string name = "live";  // of what is seen: the title of the page
  // SourceInfo::R_camera_rectified of the recording the frames are from.
  Eigen::Matrix3d R_camera_rectified = Eigen::Matrix3d::Identity();
  // Names and values of settings, such as {"stream.picture_width", "640"}
  // (docs/reference/settings.md, Stream): size, quality and rate of the camera images, and
  // precision.
  std::vector<std::pair<std::string, std::string>> settings;
};

// Its calls take turns with each other and with the driving calls of the Slam: one at a time, from
// any thread. Threads of its own encode, write and serve.
class SlamView {
 public:
  // `slam` must outlive it. Throws Error (usage) for an unknown setting.
  explicit SlamView(const Slam& slam, SlamViewOptions options = {});
  ~SlamView();  // completes the recording, as EndRecord()
  SlamView(const SlamView&) = delete;
  SlamView& operator=(const SlamView&) = delete;

  // Shows the frames from now on, and the whole map, in web browsers. Returns the address to open:
  // http://127.0.0.1:8090/. `port` 0: any free one. `host`: an address of this machine; beyond
  // loopback the returned address has a token. Called again: returns the same address. Viewers that
  // are too slow miss frames; Track() never waits for them. Throws Error (usage) if the port is in
  // use, or the module libalidade_serve is not installed.
  std::string Serve(int port = 0, const std::string& host = "127.0.0.1");

  // Records from now on. `path`: a file FILE.stream, for `alidade view`; FILE.mcap, with ROS 2
  // messages; or else a folder, created if needed, in which it is run.stream. It has its name when
  // it is complete (EndRecord()), and replaces an earlier recording of that name. No frame is left
  // out: Show() waits when the disk is slower. Throws Error (input) if it cannot be written, Error
  // (usage) if a recording is going on, or if `path` holds the results of a run.
  void Record(const std::string& path);

  // After each Track(), with what it was given and returned.
  void Show(const FrameInput& input, const TrackResult& result);

  // After Finish(): shows the final map and completes the recording. More frames may follow.
  void Finished();
  // Completes the recording; does nothing without one. Throws Error (input) if writing failed.
  void EndRecord();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace alidade
