#include "alidade/run/georeference/moved_result.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/cloud.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/image_codec.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/text.h"
#include "alidade/run/export/export_folder.h"
#include "alidade/run/export/map_models.h"
#include "alidade/run/folder/own_files.h"
#include "alidade/run/sources/truth.h"
#include "alidade/run/world/moved_map.h"
#include "alidade/view/report.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr size_t kLargest = size_t{1} << 31;  // bytes of a file that is read
constexpr int kPictureQuality = 88;           // JPEG

class MovedResult {
 public:
  MovedResult(std::string from, const std::string& out, const SavedMap& saved,
              const std::vector<AlignedMap>& maps)
      : from_(std::move(from)), maps_(maps), moved_(saved), folder_(out) {
    MoveMaps();
  }

  void Write(const ordered_json& about, const std::vector<std::string>& facts) {
    folder_.Write("map.alidade", EncodeMap(moved_));
    for (size_t k = 0; k < maps_.size(); ++k) {
      Trajectories(k);
      Clouds(k);
      DepthImages(k);
    }
    for (const char* name : {"groundtruth.txt", "camera.yaml", "mask.txt"}) Copy(name);
    if (IsFolder(from_ + "/mask")) {
      for (const std::string& name : NamesIn(from_ + "/mask")) Copy("mask/" + name);
    }
    Pictures(facts);
    Stats(about);
    folder_.Place("georeference");
  }

 private:
  Sim3 FromWritten(const AlignedMap& map) const {
    Sim3 T = map.T_new_map;
    T.R *= map.R_written_map.transpose();
    return T;
  }

  void MoveMaps() {
    std::set<MapId> kept;
    for (const AlignedMap& map : maps_) {
      MoveMap(moved_, map.part, map.T_new_map, map.world);
      kept.insert(map.id);
    }
    MapStore store;
    store.Restore(moved_.map);
    moved_.map = store.Commit([&](MapCommit& commit) {
      for (MapId id : moved_.map.Maps()) {
        if (kept.count(id) == 0) commit.Remove(id);
      }
    });
  }

  void Put(const std::string& name, const std::string& bytes) {
    folder_.Write(name, bytes);
    if (name.find('/') == std::string::npos) files_.push_back(name);
  }

  void Copy(const std::string& name) {
    if (IsFile(from_ + "/" + name)) Put(name, ReadFile(from_ + "/" + name, kLargest));
  }

  void Trajectories(size_t k) {
    const AlignedMap& map = maps_[k];
    const Sim3 T = FromWritten(map);
    for (const char* kind : {"trajectory", "keyframes"}) {
      const std::string file = from_ + "/" + NumberedFile(kind, map.number);
      Put(NumberedFile(kind, k), FormatTumTrajectory(InNewWorld(ReadTrajectory(file), T)));
    }
    const std::string live = from_ + "/trajectory_live.txt";
    if (map.number == 0 && IsFile(live))
      Put("trajectory_live.txt", FormatTumTrajectory(InNewWorld(ReadTrajectory(live), T)));
  }

  static void MoveCloud(Cloud& cloud, const Sim3& T) {
    for (Eigen::Vector3f& p : cloud.points) p = (T * p.cast<double>()).cast<float>();
    for (Eigen::Vector3f& n : cloud.normals) n = (T.R * n.cast<double>()).cast<float>();
    for (float& sigma : cloud.sigmas) sigma *= static_cast<float>(T.s);
  }

  void Clouds(size_t k) {
    const AlignedMap& map = maps_[k];
    const auto move = [&](const std::string& from, const std::string& to, CloudFormat format) {
      const std::string path = from_ + "/" + from;
      if (!IsFile(path)) return Cloud{};
      Cloud cloud = DecodePly(ReadFile(path, kLargest), path);
      MoveCloud(cloud, FromWritten(map));
      Put(to, EncodePly(cloud, format));
      return cloud;
    };
    if (map.number == 0) landmarks_ = move("landmarks.ply", "landmarks.ply", CloudFormat::kAscii);
    Cloud shape = move(NumberedFile("semidense", map.number, ".ply"),
                       NumberedFile("semidense", k, ".ply"), CloudFormat::kBinary);
    if (k == 0) shape_ = std::move(shape);
  }

  void DepthImages(size_t k) {
    const std::string list = from_ + "/" + NumberedFile("depth", maps_[k].number);
    if (!IsFile(list)) return;
    const std::string text = ReadFile(list);
    for (const TextLine& line : ContentLines(text)) {
      const std::vector<std::string_view> fields = Fields(line.text);
      if (fields.size() < 2) continue;
      const std::string name(fields[1]);
      // Only names as the run writes them.
      if (name.rfind("depth/", 0) != 0 || name.find("..") != std::string::npos) continue;
      const std::string path = from_ + "/" + name;
      const DecodedImage decoded = DecodeImageBytes(ReadFile(path), ImageUse::kDepth);
      if (decoded.image.type() != CV_16UC1) ThrowInput(path + ": " + decoded.problem);
      cv::Mat scaled = decoded.image.clone();
      scaled.forEach<uint16_t>([&](uint16_t& value, const int*) {
        const double now = value * maps_[k].T_new_map.s;
        value = now < 65535.5 ? static_cast<uint16_t>(now + 0.5) : uint16_t{0};
      });
      folder_.Write(name, EncodePng(scaled));
    }
    Put(NumberedFile("depth", k), text);
  }

  PlaceDrawing DrawingOf(const AlignedMap& map, size_t k) const {
    PlaceDrawing place;
    place.unit = "m";
    place.gravity = map.world.down;
    Trajectory path = map.trajectory;
    place.path = PathOf(InNewWorld(std::move(path), map.T_new_map));
    for (KeyFrameId id : map.part.keyframes)
      place.keyframes.push_back(moved_.map.Find(id)->Centre());
    const size_t step = 1 + map.part.landmarks.size() / 8000;
    for (size_t i = 0; i < map.part.landmarks.size(); i += step)
      place.landmarks.push_back(moved_.map.Find(map.part.landmarks[i])->p_world);
    (void)k;
    std::vector<Se3> measured;
    for (size_t i = 0; i < map.positions.positions.size(); ++i) {
      if (map.positions.used[i])
        measured.push_back({Eigen::Matrix3d::Identity(), map.positions.positions[i]});
    }
    if (!measured.empty()) place.truth = {std::move(measured)};
    return place;
  }

  void Pictures(const std::vector<std::string>& facts) {
    RunReport report;
    report.title = NameAsTyped(from_) + ", georeferenced";
    report.unit = "m";
    for (const std::string& fact : facts) {
      const size_t gap = fact.find("  ");
      const size_t text = fact.find_first_not_of(' ', std::min(gap, fact.size()));
      if (gap == std::string::npos || text == std::string::npos) continue;
      report.facts.push_back({fact.substr(0, gap), fact.substr(text)});
    }
    for (size_t k = 0; k < maps_.size(); ++k) {
      const AlignedMap& map = maps_[k];
      report.maps.push_back({std::to_string(map.trajectory.size()) + " frames", DrawingOf(map, k)});
      const PositionFit& fit = map.positions;
      if (k > 0 || fit.times.empty()) continue;
      auto& curve = report.error.emplace_back();
      for (size_t i = 0; i < fit.times.size(); ++i) {
        if (fit.used[i])
          curve.emplace_back(fit.times[i] - map.trajectory.front().time, fit.residuals[i]);
      }
      report.seconds = map.trajectory.back().time - map.trajectory.front().time;
    }
    const bool dense = !shape_.points.empty();
    CloudScene scene{dense ? shape_ : landmarks_, report.maps.front().place.path,
                     report.maps.front().place.gravity};
    if (!scene.cloud.points.empty()) {
      const cv::Mat drawn = DrawCloud(scene, CloudView::kBehind);
      if (dense) Put("semidense.png", EncodePng(drawn));
      report.cloud_picture = {"from behind the first camera", "image/jpeg",
                              EncodeJpeg(drawn, kPictureQuality)};
      report.cloud = std::move(scene);
    }
    Put("report.html", RenderReport(report));
  }

  void Stats(const ordered_json& about) {
    ordered_json stats = ordered_json::parse(ReadFile(from_ + "/" + kStatsFile));
    const MapWorld& world = maps_.front().world;
    stats["gravity"] = {world.down.x(), world.down.y(), world.down.z()};
    stats["scale"] = {
        {"known", true},
        {"sigma", world.scale_sigma > 0 ? ordered_json(world.scale_sigma) : ordered_json(nullptr)}};
    stats["georeference"] = about;
    stats["maps"] = maps_.size();
    stats["keyframes"] = moved_.map.keyframe_count();
    stats["landmarks"] = moved_.map.landmark_count();
    ordered_json list = ordered_json::array();
    for (size_t k = 0; k < maps_.size(); ++k) {
      const Trajectory& path = maps_[k].trajectory;
      list.push_back({{"trajectory", NumberedFile("trajectory", k)},
                      {"keyframes", NumberedFile("keyframes", k)},
                      {"frames", path.size()},
                      {"keyframe_count", maps_[k].part.keyframes.size()},
                      {"span", {path.front().time, path.back().time}}});
    }
    stats["map_files"] = list;
    if (!stats["folder"].is_object()) stats["folder"] = ordered_json::object();
    files_.push_back("map.alidade");
    files_.push_back(kStatsFile);
    std::sort(files_.begin(), files_.end());
    stats["folder"]["command"] = "georeference";
    stats["folder"]["files"] = files_;
    folder_.Write(kStatsFile,
                  stats.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  }

  std::string from_;
  const std::vector<AlignedMap>& maps_;
  SavedMap moved_;
  ExportFolder folder_;
  std::vector<std::string> files_;
  Cloud landmarks_, shape_;
};

}  // namespace

void WriteMovedResult(const std::string& from, const std::string& out, const SavedMap& saved,
                      const std::vector<AlignedMap>& maps, const ordered_json& about,
                      const std::vector<std::string>& facts) {
  MovedResult(from, out, saved, maps).Write(about, facts);
}

}  // namespace alidade
