// Pose optimisation and local bundle adjustment, on the map the recording gives; what closing a
// loop solves, on generated problems.
#include <cmath>

#include "alidade/base/error.h"
#include "alidade/base/random.h"
#include "alidade/base/timing.h"
#include "alidade/mapping/local_window.h"
#include "alidade/optimize/pose_only.h"
#include "alidade/optimize/sim3_refine.h"
#include "alidade/slam.h"
#include "bench/measure/reference.h"
#include "bench/parts/parts.h"
#include "problems/bundle_problem.h"
#include "problems/pose_graph_problem.h"
#include "problems/sim3_problem.h"

namespace alidade::bench {
namespace {

Vector6d Nudge(Random& random, double metres, double radians) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? metres : radians) * random.Gaussian();
  return xi;
}

// A pose to find again, as tracking has it: from a centimetre and half a degree away.
struct PoseTask {
  Se3 start;
  std::vector<PoseMatch> matches;
};

std::vector<PoseTask> MakePoseTasks(const MapSnapshot& map, const MeasurementNoise& noise) {
  Random random(1);
  std::vector<PoseTask> tasks;
  for (KeyFrameId id : map.KeyFrames()) {
    const KeyFrame& keyframe = *map.Find(id);
    PoseTask task;
    task.start = Se3::Exp(Nudge(random, 0.01, 0.009)) * keyframe.T_camera_world;
    for (size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (!keyframe.landmarks[i].valid()) continue;
      const Measurement m = Measure(keyframe.frame->keypoints[i], noise);
      task.matches.push_back(
          {map.Find(keyframe.landmarks[i])->p_world, m.pixel, m.inv_sigma2, m.inv_sigma2_right});
    }
    if (task.matches.size() >= 20) tasks.push_back(std::move(task));
  }
  return tasks;
}

// The map as it may look before an adjustment: everything a few millimetres off, so that there is
// something to do.
MapSnapshot Shaken(const MapSnapshot& map) {
  Random random(2);
  MapStore store;
  store.Restore(map);
  return store.Commit([&](MapCommit& commit) {
    for (KeyFrameId id : map.KeyFrames()) {
      KeyFrame* keyframe = commit.Edit(id);
      if (keyframe->parent.valid())
        keyframe->T_camera_world = Se3::Exp(Nudge(random, 0.003, 0.002)) * keyframe->T_camera_world;
    }
    for (LandmarkId id : map.Landmarks()) {
      commit.Edit(id)->p_world += Nudge(random, 0.01, 0).head<3>();
    }
  });
}

// A loop of 300 keyframes: the match that closes it, the pose graph, and the adjustment of all.
Section BenchLoop(const Recording& recording) {
  const Sim3Problem match = MakeSim3Problem({.matches = 100, .outliers = 0.5});
  const PoseGraphProblem drifted = MakePoseGraphProblem({.nodes = 1000, .neighbours = 4});
  const BundleProblem map = MakeBundleProblem({.scene = BundleScene::kRing,
                                               .fixed_cameras = 1,
                                               .free_cameras = 300,
                                               .points = 20000,
                                               .path_length = 44,
                                               .min_track = 3,
                                               .max_track = 12,
                                               .stereo = 0.7,
                                               .outliers = 0.02});
  const auto verify = [&](int turn) {
    const Sim3RansacResult found =
        SolveSim3Ransac(match.camera, match.matches, {.seed = static_cast<uint64_t>(turn)});
    RefineSim3(match.camera, found.T_a_b, match.matches, true);
  };
  const auto graph = [&](int) {
    PoseGraph copy = drifted.graph;
    OptimizePoseGraph(copy);
  };
  const auto adjust = [&](int) {
    BundleProblem copy = map;
    AdjustBundle(copy, {.max_iterations = 5, .min_relative_decrease = 0});
  };
  const std::string nodes = std::to_string(drifted.graph.T_camera_world.size()) + " nodes, " +
                            std::to_string(drifted.graph.edges.size()) + " edges";
  const std::string size = "300 keyframes, 20000 points, " +
                           std::to_string(map.observations.size()) + " sightings, 5 iterations";
  return TakeTurns("loop", recording,
                   {{"similarity: RANSAC and refinement", verify, 1, "100 matches, half wrong"},
                    {"pose graph with scale, 1 thread", graph, 1, nodes},
                    {"adjustment of a whole map, 1 thread", adjust, 1, size},
                    {"adjustment of a whole map, all threads", adjust, 0, size}},
                   10);
}

}  // namespace

Section BenchBundle(const Recording& recording) {
  SlamSettings settings;
  settings.sensor = recording.info.sensor;
  Slam slam(recording.info.camera, settings);
  Reference reference;
  std::vector<double> u;
  for (const SourceFrame& frame : recording.frames) {
    u.push_back(reference.Run(frame.image));
    slam.Track({frame.time, frame.image, frame.right, frame.depth});
  }
  const MapSnapshot map = slam.Snapshot();
  MapperSettings mapper = settings.mapper;
  mapper.noise.right_from_sensor = slam.camera().baseline <= 0;
  const std::vector<PoseTask> tasks = MakePoseTasks(map, mapper.noise);
  if (tasks.empty() || map.keyframe_count() < 3)
    ThrowInput("ba: no map can be made of " + recording.source);

  const MapSnapshot shaken = Shaken(map);
  std::vector<KeyFrameId> keyframes = shaken.KeyFrames();
  keyframes.erase(keyframes.begin(),
                  keyframes.begin() + static_cast<std::ptrdiff_t>(keyframes.size() / 3));
  double matches = 0, windows = 0, points = 0;
  for (const PoseTask& task : tasks)
    matches += static_cast<double>(task.matches.size()) / static_cast<double>(tasks.size());
  for (KeyFrameId id : keyframes) {
    const Adjustment result = AdjustWindow(shaken, id, slam.camera(), mapper, nullptr);
    windows += static_cast<double>(result.poses.size()) / static_cast<double>(keyframes.size());
    points += static_cast<double>(result.points.size()) / static_cast<double>(keyframes.size());
  }
  const auto rounded = [](double v) { return std::to_string(static_cast<int>(std::lround(v))); };
  const std::string size = rounded(windows) + " keyframes, " + rounded(points) + " points, " +
                           std::to_string(mapper.bundle.max_iterations) + " iterations at most";
  const auto pose = [&](int turn) {
    const PoseTask& task = tasks[static_cast<size_t>(turn) % tasks.size()];
    OptimizePose(slam.camera(), task.start, task.matches);
  };
  const auto window = [&](int turn) {
    AdjustWindow(shaken, keyframes[static_cast<size_t>(turn) % keyframes.size()], slam.camera(),
                 mapper, nullptr);
  };
  Section section = TakeTurns("ba", recording,
                              {{"pose optimisation", pose, 1, rounded(matches) + " matches"},
                               {"local bundle adjustment, 1 thread", window, 1, size},
                               {"local bundle adjustment, all threads", window, 0, size}},
                              60);
  section.timings.push_back(TimingOf("all of mapping, inline", recording, slam.Times().map,
                                     "per keyframe, in the run itself"));
  const Section loop = BenchLoop(recording);
  section.timings.insert(section.timings.end(), loop.timings.begin(), loop.timings.end());
  return section;
}

}  // namespace alidade::bench
