#include "alidade/run/outputs.h"

#include <exception>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/cloud.h"
#include "alidade/run/calibration/unknown_camera.h"
#include "alidade/run/report/keyframe_pictures.h"
#include "alidade/run/report/shape_views.h"
#include "alidade/run/report/stats.h"
#include "alidade/run/results/run_results.h"
#include "alidade/run/results/semidense_outputs.h"

namespace alidade {
namespace {

Cloud LandmarksOf(const RunResults& results) {
  Cloud cloud;
  for (LandmarkId id : results.map.Landmarks()) {  // those of other maps have other world frames
    if (results.map.MapOf(results.map.Find(id)->reference) != results.maps.front().id) continue;
    cloud.points.push_back(
        (results.R_camera_rectified * results.map.Find(id)->p_world).cast<float>());
  }
  return cloud;
}

}  // namespace

RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunRecord& record,
                        bool with_map, MaskWriter* masks) {
  RunResults results;
  Cloud shape;
  Cloud landmarks;
  ReportPictures pictures;
  std::exception_ptr failure;  // the first exception other than of the disk or the folder
  // Continues with the next file if memory is exhausted.
  const auto attempt = [&](const auto& write) {
    try {
      write();
    } catch (const Error&) {
      throw;
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  try {
    results = ResultsOf(slam, record);
    for (size_t i = 0; i < results.maps.size(); ++i) {
      const MapResults& map = results.maps[i];
      if (i > 0 && map.trajectory.empty()) break;  // a loaded map that was not seen
      folder.Write(NumberedFile("trajectory", i), FormatTumTrajectory(map.trajectory));
      folder.Write(NumberedFile("keyframes", i), FormatTumTrajectory(map.keyframes));
    }
    folder.Write("trajectory_live.txt", FormatTumTrajectory(results.maps.front().live));
    if (!record.truth.empty()) {
      folder.Write("groundtruth.txt", FormatTumTrajectory(record.truth));
    }
    folder.Write("stats.json", StatsJson(record, results));
    if (const std::string camera = FoundCameraFile(record); !camera.empty())
      folder.Write("camera.yaml", camera);
    attempt([&] {
      if (with_map) folder.Write("map.alidade", slam.SaveMap());
    });
    attempt([&] {
      landmarks = LandmarksOf(results);
      folder.Write("landmarks.ply", EncodePly(landmarks, CloudFormat::kAscii));
    });
    attempt([&] {
      if (!record.settings.semidense.enabled) return;
      const double voxel = record.settings.semidense.voxel;
      shape = WriteSemiDense(folder, results, slam.camera(), voxel);
      if (!shape.points.empty())
        pictures.shape = WriteShapeViews(folder, results, slam.camera(), shape, voxel);
    });
    // The report is also written without images.
    attempt([&] {
      if (pictures.shape.scene.cloud.points.empty() && !landmarks.points.empty())
        pictures.shape = LandmarkViews(results, std::move(landmarks));
    });
    attempt([&] {
      pictures.keyframes =
          DrawKeyframes(record.album, results, slam, record.first_time.value_or(0));
    });
    attempt([&] { folder.Write("report.html", ReportHtml(record, results, std::move(pictures))); });
    attempt([&] {
      if (masks) masks->Finish();
    });
  } catch (...) {
    if (masks) masks->Discard();
    throw;
  }
  if (failure) std::rethrow_exception(failure);
  return {record.frames,
          results.tracked,
          results.map.keyframe_count(),
          results.map.landmark_count(),
          static_cast<int>(results.map.Maps().size()),
          results.initialised_at,
          results.lost_spans,
          shape.points.size(),
          PathLength(results.maps.front().trajectory)};
}

}  // namespace alidade
