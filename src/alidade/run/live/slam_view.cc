#include "alidade/run/live/slam_view.h"

#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "alidade/base/error.h"
#include "alidade/base/log.h"
#include "alidade/io/files/file.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/recorder/record_file.h"
#include "alidade/run/recorder/stream_feed.h"
#include "alidade/run/setup/run_settings.h"
#include "alidade/serve/viewer_server.h"
#include "alidade/system/health.h"
#include "alidade/version.h"

namespace alidade {
namespace {

constexpr char kProgramName[] = "alidade " ALIDADE_VERSION;

// The file for SlamView::Record(); its folder exists.
std::string RecordPathFor(const std::string& path) {
  namespace fs = std::filesystem;
  if (path.empty()) ThrowUsage("the path of a recording is empty");
  if (IsMcap(path) || fs::path(path).extension() == ".stream") return path;
  if (IsFile(path))
    ThrowUsage(path + " is a file: give a folder, or a name that ends in .stream or .mcap");
  if (IsFile(path + "/" + kStatsFile))
    ThrowUsage(path +
               " holds the results of a run: give another folder, or a name that ends in .stream "
               "or .mcap");
  std::error_code error;
  fs::create_directories(path, error);
  if (error) ThrowInput(path + ": cannot be created (" + error.message() + ")");
  return path + "/run.stream";
}

// JPEG has no fourth channel.
cv::Mat WithoutAlpha(const cv::Mat& image) {
  if (image.channels() != 4) return image;
  cv::Mat color;
  cv::cvtColor(image, color, cv::COLOR_BGRA2BGR);
  return color;
}

}  // namespace

class SlamView::Impl {
 public:
  Impl(const Slam& slam, SlamViewOptions options) : slam_(slam), options_(std::move(options)) {
    RunSettings settings;
    for (const auto& [name, value] : options_.settings) settings.Set(name, value);
    settings.stream.Check();
    settings_ = settings.stream;
  }
  ~Impl() {
    try {
      EndRecord();
    } catch (...) {
      LogWarning(WhatOf(std::current_exception()));
    }
  }

  std::string Serve(int port, const std::string& host) {
    if (server_) return server_->address();
    ServeSettings serve;
    serve.host = host;
    serve.port = port;
    serve.port_given = true;
    serve.Check();
    shown_.emplace(kProgramName, std::nullopt, settings_);
    try {
      shown_->BeginLive(slam_, Source());
      server_ = StartViewer(serve, &*shown_, "", options_.name);
    } catch (...) {
      shown_.reset();
      throw;
    }
    return server_->address();
  }

  void Record(const std::string& path) {
    if (recorded_) ThrowUsage("a recording is going on: end it first");
    recorded_.emplace(kProgramName, RecordPathFor(path), settings_);
    try {
      recorded_->BeginLive(slam_, Source());
    } catch (...) {
      recorded_.reset();
      throw;
    }
  }

  void Show(const FrameInput& input, const TrackResult& result) {
    if (!shown_ && !recorded_) return;
    SourceFrame frame;
    frame.time = input.time;
    frame.number = slam_.frames() - 1;
    frame.image = WithoutAlpha(input.image);
    frame.color = WithoutAlpha(input.color);
    if (shown_) shown_->Frame(frame, result);
    if (recorded_) recorded_->Frame(frame, result);
  }

  void Finished() {
    if (shown_) shown_->Finished();
    EndRecord();
  }

  void EndRecord() {
    if (!recorded_) return;
    // Gone also when writing failed.
    std::optional<StreamFeed>& ended = recorded_;
    const struct Reset {
      std::optional<StreamFeed>& feed;
      ~Reset() { feed.reset(); }
    } reset{ended};
    ended->Finished();
    ended->Written("");
  }

 private:
  StreamSource Source() const {
    StreamSource source;
    source.source = options_.name;
    source.sensor = slam_.Saved().sensor;
    source.unit = source.sensor == NameOf(Sensor::kMono) ? "map units" : "m";
    source.live = true;
    source.camera = slam_.camera();
    source.R_camera_rectified = options_.R_camera_rectified;
    return source;
  }

  const Slam& slam_;
  const SlamViewOptions options_;
  StreamFeedSettings settings_;
  std::optional<StreamFeed> shown_, recorded_;
  std::unique_ptr<ViewerServer> server_;  // ends before what it serves
};

SlamView::SlamView(const Slam& slam, SlamViewOptions options)
    : impl_(std::make_unique<Impl>(slam, std::move(options))) {}
SlamView::~SlamView() = default;

std::string SlamView::Serve(int port, const std::string& host) { return impl_->Serve(port, host); }
void SlamView::Record(const std::string& path) { impl_->Record(path); }
void SlamView::Show(const FrameInput& input, const TrackResult& result) {
  impl_->Show(input, result);
}
void SlamView::Finished() { impl_->Finished(); }
void SlamView::EndRecord() { impl_->EndRecord(); }

}  // namespace alidade
