#include "alidade/run/service/localize_host.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>

#include "alidade/base/error.h"
#include "alidade/base/parallel.h"
#include "alidade/geometry/picture_size.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/run/service/picture_query.h"
#include "alidade/version.h"

namespace alidade {
namespace {

using nlohmann::json;

std::string TextOfJson(const json& told) {
  return told.dump(-1, ' ', false, json::error_handler_t::replace);
}

PostAnswer Refused(int status, const std::string& error) {
  return {status, TextOfJson({{"placed", false}, {"error", error}})};
}

json List(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json Rows(const Matrix6d& matrix) {
  json rows = json::array();
  for (int r = 0; r < 6; ++r) {
    json row = json::array();
    for (int c = 0; c < 6; ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

// The pose of a picture without one, if there is a guess, is told with its probability.
json Told(const Placement& found) {
  json told = {{"placed", found.placed()}, {"keypoints", found.keypoints}};
  if (!found.placed()) {
    told["reason"] = NameOf(found.why);
    told["why"] = WordsOf(found.why);
    if (found.why == NoPlace::kBlank || found.why == NoPlace::kUnknown) return told;
  }
  const Eigen::Quaterniond q = found.T_world_camera.Quaternion();
  told["position"] = List(found.T_world_camera.t);
  told["quaternion"] = {q.x(), q.y(), q.z(), q.w()};
  told["covariance"] = Rows(found.covariance);
  told["probability"] = found.probability;
  told["inliers"] = found.inliers;
  told["expected"] = found.expected;
  told["agreement"] = found.agreement;
  told["map"] = found.map.value;
  told["keyframe"] = found.keyframe.value;
  told["unit"] = found.meters ? "meters" : "map units";
  return told;
}

}  // namespace

LocalizeHost::LocalizeHost(SavedMap map, std::string name, const LocalizeHostSettings& settings)
    : localizer_(std::move(map)), name_(std::move(name)), settings_(settings) {
  const int threads =
      settings.threads > 0 ? settings.threads : std::max(1U, std::thread::hardware_concurrency());
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
}

LocalizeHost::~LocalizeHost() {
  {
    const std::lock_guard lock(mutex_);
    end_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool LocalizeHost::Take(PostRequest request, PostReply reply) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= settings_.most_waiting) return false;
    waiting_.emplace_back(std::move(request), std::move(reply));
  }
  wake_.notify_one();
  return true;
}

void LocalizeHost::Work() {
  KeepLoopsOnThisThread();  // the threads share the cores by pictures
  while (true) {
    std::pair<PostRequest, PostReply> next;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return end_ || !waiting_.empty(); });
      if (end_) return;
      next = std::move(waiting_.front());
      waiting_.pop_front();
    }
    PostAnswer answer;
    try {
      answer = Answer(next.first);
    } catch (const std::bad_alloc&) {
      answer = Refused(503, "there is not enough memory for this picture");
    } catch (const std::exception& error) {
      answer = Refused(500, std::string("internal error: ") + error.what());
    }
    next.first = {};  // its bytes
    next.second(std::move(answer));
  }
}

PostAnswer LocalizeHost::Answer(const PostRequest& request) const {
  const auto start = std::chrono::steady_clock::now();
  const std::string& bytes = request.body;
  if (bytes.empty())
    return Refused(400, "the request has no picture: curl --data-binary @photo.jpg …");
  const bool jpeg = LooksLikeJpeg(bytes);
  if (!jpeg && !LooksLikePng(bytes))
    return Refused(415, "the body of the request must be a JPEG or PNG, as it is in its file");
  const cv::Size size = jpeg ? JpegSize(bytes) : PngSize(bytes);
  if (size.width == 0) return Refused(422, "the picture is damaged: its header cannot be read");
  if (!IsPictureSize(size.width, size.height))
    return Refused(413, TooLargeText(size.width, size.height));
  Calibration camera;
  double least = 0;
  try {
    std::map<std::string, std::string> query = QueryOf(request.query);
    least = TakeProbability(query);
    camera = CalibrationOfQuery(query, size, bytes, localizer_.saved().camera);
  } catch (const Error& error) {
    return Refused(400, error.what());
  }
  DecodedImage decoded = DecodeImageBytes(bytes, ImageUse::kGray);
  if (!decoded.problem.empty()) return Refused(422, "the picture " + decoded.problem);
  if (decoded.image.depth() == CV_16U) decoded.image.convertTo(decoded.image, CV_8U, 1 / 256.0);
  try {
    json told = Told(localizer_.Localize(decoded.image, camera, least));
    told["camera"] = {{"fx", camera.left.fx}, {"fy", camera.left.fy}};
    const std::chrono::duration<double, std::milli> taken =
        std::chrono::steady_clock::now() - start;
    told["milliseconds"] = std::round(10 * taken.count()) / 10;
    return {200, TextOfJson(told)};
  } catch (const Error& error) {
    return Refused(400, error.what());
  }
}

std::string LocalizeHost::Info() const {
  const SavedMap& saved = localizer_.saved();
  const Camera& camera = saved.camera;
  json maps = json::array();
  for (const MapId id : saved.map.Maps()) {
    Eigen::AlignedBox3d box;
    const std::vector<KeyFrameId> keyframes = saved.map.KeyFramesOf(id);
    for (const KeyFrameId keyframe : keyframes) box.extend(saved.map.Find(keyframe)->Centre());
    maps.push_back({{"map", id.value},
                    {"keyframes", keyframes.size()},
                    {"unit", InMeters(saved, id) ? "meters" : "map units"},
                    {"from", List(box.min())},
                    {"to", List(box.max())}});
  }
  const json info = {{"mode", "localize"},
                     {"program", "alidade " ALIDADE_VERSION},
                     {"name", name_},
                     {"sensor", saved.sensor},
                     {"keyframes", saved.map.keyframe_count()},
                     {"landmarks", saved.map.landmark_count()},
                     {"camera",
                      {{"width", camera.width},
                       {"height", camera.height},
                       {"fx", camera.fx},
                       {"fy", camera.fy},
                       {"cx", camera.cx},
                       {"cy", camera.cy},
                       {"distortion", camera.distortion}}},
                     {"maps", std::move(maps)}};
  return TextOfJson(info);
}

}  // namespace alidade
