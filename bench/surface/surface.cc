#include "bench/surface/surface.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <unordered_set>

#include "alidade/base/error.h"
#include "alidade/evaluation/ate.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/run/run.h"
#include "alidade/run/sources/synth_source.h"
#include "alidade/run/surface/surface_results.h"
#include "bench/measure/print.h"
#include "bench/measure/result_file.h"
#include "problems/surface_truth.h"

namespace alidade::bench {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostVertices = 20000;  // that are compared with the scene

double Seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Exact depth at the true poses of the frames that have these times.
std::vector<DenseView> TrueViews(const SynthRecording& recording, const Trajectory& keyframes) {
  std::vector<DenseView> views;
  for (int i = 0; i < recording.frames(); ++i) {
    const bool used = std::any_of(keyframes.begin(), keyframes.end(), [&](const StampedPose& pose) {
      return std::abs(pose.time - recording.Time(i)) < 1e-4;
    });
    if (!used) continue;
    DenseView view;
    view.camera = recording.camera();
    view.T_world_camera = recording.Pose(i);
    view.depth = recording.Render(i).depth_exact;
    views.push_back(view);
  }
  return views;
}

// Share of what the views see, within `range`, that has a vertex within a voxel and a half.
double Completeness(const Mesh& mesh, const Se3& T_scene_world, double voxel,
                    const std::vector<DenseView>& views, double range) {
  const double cell = 1.5 * voxel;
  const auto place = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector3i((p / cell).array().floor().cast<int>());
  };
  std::unordered_set<uint64_t> taken;
  for (const Eigen::Vector3f& p : mesh.vertices.points)
    taken.insert(KeyOf(place(T_scene_world * p.cast<double>())));
  int count = 0, found = 0;
  for (const DenseView& view : views) {
    for (int y = 4; y < view.depth.rows; y += 8) {
      for (int x = 4; x < view.depth.cols; x += 8) {
        const double z = view.depth(y, x);
        if (!(z > 0 && z <= range)) continue;
        const Eigen::Vector3i at = place(view.T_world_camera * view.camera.Unproject({x, y}, z));
        bool near = false;
        for (int i = 0; i < 27 && !near; ++i)
          near = taken.count(KeyOf(at + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1))) > 0;
        ++count;
        found += near ? 1 : 0;
      }
    }
  }
  return 100.0 * found / std::max(1, count);
}

struct SurfaceFigures {
  double ate, median, p90, complete, triangles, megabytes, free, walls, hit, run_s, mesh_s, grid_s;
};

SurfaceFigures Measure(const std::string& source, const std::string& sensor) {
  SurfaceFigures figures{};
  const fs::path folder =
      fs::temp_directory_path() / ("alidade-surface-" + std::to_string(getpid()));
  RunOptions options;
  options.source = source;
  options.out = folder.string();
  options.sensor = sensor;
  const std::unique_ptr<void, std::function<void(void*)>> cleanup(
      &figures, [&](void*) { fs::remove_all(folder); });
  figures.run_s = Seconds([&] { Run(options, {}); });
  MeshResult mesh;
  GridResult grid;
  const GridSettings grid_settings;
  figures.mesh_s = Seconds([&] { mesh = MakeMesh(folder.string(), {}); });
  figures.grid_s = Seconds([&] {
    try {
      grid = MakeGrid(folder.string(), grid_settings);
    } catch (const Error&) {  // no floor in sight
      figures.free = figures.walls = figures.hit = NAN;
    }
  });
  const AteResult ate = EvaluateAte(ReadTrajectory((folder / "groundtruth.txt").string()),
                                    ReadTrajectory((folder / "trajectory.txt").string()));
  const Se3 T_scene_world{ate.T_truth_estimate.R, ate.T_truth_estimate.t};
  figures.ate = 100 * ate.error.rmse;
  const SynthSettings settings = ParseSynthSource(source);
  const SynthRecording recording = MakeSynthRecording(settings);
  const SurfaceTruth truth(settings);
  std::vector<double> distances;
  const auto& points = mesh.mesh.vertices.points;
  const size_t step = std::max<size_t>(1, points.size() / kMostVertices);
  for (size_t i = 0; i < points.size(); i += step)
    distances.push_back(100 * truth.Distance(T_scene_world * points[i].cast<double>()));
  std::sort(distances.begin(), distances.end());
  figures.median = distances[distances.size() / 2];
  figures.p90 = distances[distances.size() * 9 / 10];
  figures.triangles = 1e-3 * static_cast<double>(mesh.mesh.triangles.size());
  figures.megabytes = 1e-6 * static_cast<double>(mesh.bytes);
  const auto views = TrueViews(recording, ReadTrajectory((folder / "keyframes.txt").string()));
  DenseView kind;
  kind.inverse_sigma = mesh.views.inverse_sigma;
  TsdfSettings tsdf;
  tsdf.voxel = mesh.voxel;
  figures.complete =
      Completeness(mesh.mesh, T_scene_world, mesh.voxel, views, tsdf.RangeFor(kind.inverse_sigma));
  if (grid.picture.cells.empty()) return figures;
  const GridScore score =
      ScoreGrid(grid.picture, grid_settings.occupancy, grid.T_grid_world * T_scene_world.Inverse(),
                views, grid_settings.occupancy.SharpRange(kind));
  figures.free = 100 * score.FreeShare();
  figures.walls = 100 * score.WallShare();
  figures.hit = 100.0 * score.walls_free / std::max(1, score.walls);
  return figures;
}

}  // namespace

int BenchSurface(const SurfaceOptions& options) {
  Section section{"surface"};
  Table table{"surface",
              {{"ate", "cm"},
               {"median", "cm"},
               {"p90", "cm"},
               {"complete", "%"},
               {"triangles", "1000"},
               {"megabytes", "MB"},
               {"free", "%"},
               {"walls", "%"},
               {"walls_free", "%"},
               {"run", "s"},
               {"mesh", "s"},
               {"grid", "s"}}};
  const std::vector<std::string> scenes =
      options.scenes.empty() ? std::vector<std::string>{"room", "desk", "table", "loop"}
                             : options.scenes;
  for (const std::string& scene : scenes) {
    for (const std::string sensor : {"rgbd", "stereo"}) {
      for (int seed = 1; seed <= options.seeds; ++seed) {
        const std::string source = "synth:" + scene + "?frames=" + std::to_string(options.frames) +
                                   "&seed=" + std::to_string(seed) +
                                   (sensor == "stereo" ? "&stereo" : "");
        const SurfaceFigures f = Measure(source, sensor);
        Case of{scene, sensor};
        of.source = source;
        of.frames = options.frames;
        of.seed = seed;
        table.lines.push_back({of,
                               {f.ate, f.median, f.p90, f.complete, f.triangles, f.megabytes,
                                f.free, f.walls, f.hit, f.run_s, f.mesh_s, f.grid_s}});
        std::printf(
            "%s %s %d: ate %.2f, mesh %.2f/%.2f cm %.1f %%, grid free %.2f walls %.2f hit %.2f, "
            "%.1f + %.1f + %.1f s\n",
            scene.c_str(), sensor.c_str(), seed, f.ate, f.median, f.p90, f.complete, f.free,
            f.walls, f.hit, f.run_s, f.mesh_s, f.grid_s);
      }
    }
  }
  section.tables.push_back(table);
  PrintSection(section);
  WriteResult(options.out, "surface", {section});
  return 0;
}

}  // namespace alidade::bench
