#include "run_outputs.h"

#include <vector>

#include "alidade/base/error.h"
#include "alidade/io/cloud.h"
#include "run_results.h"
#include "run_stats.h"
#include "semidense_outputs.h"
#include "shape_views.h"

namespace alidade {
namespace {

std::string LandmarksPly(const RunResults& results) {
  Cloud cloud;
  for (LandmarkId id : results.map.Landmarks()) {  // others lie in worlds of their own
    if (results.map.MapOf(results.map.Find(id)->reference) != results.maps.front().id) continue;
    cloud.points.push_back(
        (results.R_camera_rectified * results.map.Find(id)->p_world).cast<float>());
  }
  return EncodePly(cloud, CloudFormat::kAscii);
}

}  // namespace

RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record,
                        bool with_map, MaskWriter* masks) {
  const RunResults results = ResultsOf(slam, record);
  Cloud shape;
  std::vector<ReportPicture> views;
  bool useful = false;
  try {
    for (size_t i = 0; i < results.maps.size(); ++i) {
      const MapResults& map = results.maps[i];
      if (i > 0 && map.trajectory.empty()) break;  // of a loaded map nothing was seen of
      folder.Write(NumberedFile("trajectory", i), FormatTumTrajectory(map.trajectory));
      folder.Write(NumberedFile("keyframes", i), FormatTumTrajectory(map.keyframes));
    }
    folder.Write("trajectory_live.txt", FormatTumTrajectory(results.maps.front().live));
    if (!record.truth.empty()) {
      folder.Write("groundtruth.txt", FormatTumTrajectory(record.truth));
    }
    folder.Write("stats.json", StatsJson(record, results));
    useful = true;
    if (with_map) folder.Write("map.alidade", slam.SaveMap());
    folder.Write("landmarks.ply", LandmarksPly(results));
    if (record.settings.semidense.enabled) {
      const double voxel = record.settings.semidense.voxel;
      shape = WriteSemiDense(folder, results, slam.camera(), voxel);
      if (!shape.points.empty())
        views = WriteShapeViews(folder, results, slam.camera(), shape, voxel);
    }
    folder.Write("report.html", ReportHtml(record, results, views));
    if (masks) masks->Finish();
  } catch (const Error&) {
    if (masks) masks->Discard();
    if (!useful) folder.Remove();
    throw;
  }
  return {record.frames,
          results.tracked,
          results.map.keyframe_count(),
          results.map.landmark_count(),
          static_cast<int>(results.map.Maps().size()),
          shape.points.size(),
          PathLength(results.maps.front().trajectory)};
}

}  // namespace alidade
