#include "alidade/run/outputs.h"

#include <exception>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/base/memory.h"
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

RunSummary WriteOutputs(OutputFolder& folder, const Slam& slam, const RunSetup& setup,
                        const CameraFinding& camera, const RunLog& log, MaskWriter* masks) {
  RunResults results;
  Cloud shape;
  Cloud landmarks;
  ReportPictures pictures;
  std::exception_ptr failure;  // the first exception other than of the disk or the folder
  // Continues with the next file if memory is exhausted.
  const auto attempt = [&](const auto& write) {
    ReturnFreedMemory();  // so that the process takes no more than in the run
    try {
      write();
    } catch (const Error&) {
      throw;
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  try {
    results = ResultsOf(slam, log, setup.source.R_camera_rectified);
    for (size_t i = 0; i < results.maps.size(); ++i) {
      const MapResults& map = results.maps[i];
      if (i > 0 && map.trajectory.empty()) break;  // a loaded map that was not seen
      folder.Write(NumberedFile("trajectory", i), FormatTumTrajectory(map.trajectory));
      folder.Write(NumberedFile("keyframes", i), FormatTumTrajectory(map.keyframes));
    }
    folder.Write("trajectory_live.txt", FormatTumTrajectory(results.maps.front().live));
    if (!log.truth.empty()) {
      folder.Write("groundtruth.txt", FormatTumTrajectory(log.truth));
    }
    folder.Write("stats.json", StatsJson(setup, camera, log, results));
    if (const std::string file = FoundCameraFile(camera, setup.source_path); !file.empty())
      folder.Write("camera.yaml", file);
    attempt([&] {
      if (!setup.settings.slam.localize) folder.Write("map.alidade", slam.SaveMap());
    });
    attempt([&] {
      landmarks = LandmarksOf(results);
      folder.Write("landmarks.ply", EncodePly(landmarks, CloudFormat::kAscii));
    });
    attempt([&] {
      if (!setup.settings.slam.semidense.enabled) return;
      const double voxel = setup.settings.slam.semidense.voxel;
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
      pictures.keyframes = DrawKeyframes(log.album, results, slam, log.first_time.value_or(0));
    });
    attempt([&] {
      folder.Write("report.html",
                   ReportHtml(setup, camera, log, results, folder.path(), std::move(pictures)));
    });
    attempt([&] {
      if (masks) masks->Finish();
    });
  } catch (...) {
    if (masks) masks->Discard();
    throw;
  }
  if (failure) std::rethrow_exception(failure);
  return {log.frames,
          results.tracked,
          results.map.keyframe_count(),
          results.map.landmark_count(),
          static_cast<int>(results.map.Maps().size()),
          results.initialized_at,
          results.lost_spans,
          shape.points.size(),
          PathLength(results.maps.front().trajectory),
          IsMetric(setup, results.maps.front())};
}

}  // namespace alidade
