#include "alidade/run/results/semidense_outputs.h"

#include <string>
#include <utility>
#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/files/image_codec.h"

namespace alidade {
namespace {

bool HasDepth(const KeyFrame& keyframe) {
  return keyframe.depth != nullptr && !keyframe.depth->pixels.empty();
}

std::string StampOf(const StampedPose& pose) {
  return pose.stamp.empty() ? FormatTime(pose.time) : pose.stamp;
}

// Writes the images of one map, appending their names to `written`; returns their list.
std::string WritePictures(OutputFolder& folder, const RunResults& results, const MapResults& map,
                          const Camera& camera, std::vector<std::string>& written) {
  std::string list;
  for (size_t i = 0; i < map.keyframe_ids.size(); ++i) {
    const KeyFrame& keyframe = *results.map.Find(map.keyframe_ids[i]);
    if (!HasDepth(keyframe)) continue;
    const std::string stamp = StampOf(map.keyframes[i]), name = DepthPictureFile(stamp);
    const double scale = PlaceDepth(keyframe).scale;
    written.push_back(name);
    // Images are not flushed individually, which would take longer than rendering them.
    folder.Write(name, EncodePng(DrawDepth(*keyframe.depth, scale, camera)), Sync::kNo);
    list += stamp;
    list += " ";
    list += name;
    list += "\n";
  }
  return list;
}

// All images before all lists, so that every listed image exists.
void WriteDepth(OutputFolder& folder, const RunResults& results, const Camera& camera) {
  std::vector<std::string> written;
  try {
    std::vector<std::pair<std::string, std::string>> lists;
    for (size_t i = 0; i < results.maps.size(); ++i) {
      const std::string list = WritePictures(folder, results, results.maps[i], camera, written);
      if (!list.empty()) lists.push_back({NumberedFile("depth", i), list});
    }
    for (const auto& [name, list] : lists) {
      written.push_back(name);
      folder.Write(name, std::string(kDepthListHeader) + list);
    }
  } catch (...) {
    for (const std::string& name : written) folder.Discard(name);
    throw;
  }
}

}  // namespace

std::vector<PlacedDepth> DepthOf(const RunResults& results, const MapResults& map) {
  std::vector<PlacedDepth> depth;
  for (KeyFrameId id : map.keyframe_ids) {
    const KeyFrame& keyframe = *results.map.Find(id);
    if (!HasDepth(keyframe)) continue;
    PlacedDepth placed = PlaceDepth(keyframe);
    placed.T_world_camera =
        Se3{results.R_camera_rectified, Eigen::Vector3d::Zero()} * placed.T_world_camera;
    depth.push_back(placed);
  }
  return depth;
}

Cloud WriteSemiDense(OutputFolder& folder, const RunResults& results, const Camera& camera,
                     double voxel) {
  WriteDepth(folder, results, camera);
  Cloud first;
  for (size_t i = 0; i < results.maps.size(); ++i) {
    const std::vector<PlacedDepth> depth = DepthOf(results, results.maps[i]);
    if (depth.empty()) continue;
    Cloud cloud = MakeDepthCloud(depth, camera, voxel);
    folder.Write(NumberedFile("semidense", i, ".ply"), EncodePly(cloud, CloudFormat::kBinary));
    if (i == 0) first = std::move(cloud);
  }
  return first;
}

}  // namespace alidade
