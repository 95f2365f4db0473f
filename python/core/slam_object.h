// Slam as held by Python objects.
#pragma once

#include <unistd.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "alidade/run/live/slam_view.h"
#include "alidade/run/results/run_log.h"
#include "alidade/run/results/run_results.h"
#include "alidade/system/slam.h"
#include "arrays.h"
#include "map_value.h"

namespace alidade::python {

struct TrackedFrame {
  TrackResult result;
  int frame = 0;    // number of previous frames
  double time = 0;  // seconds
};

// All methods may be called from any thread. Calls that change the state are serialized; the GIL is
// released while the library works. Calls after Close() throw Error (usage). Close() does not wait:
// running calls end normally, and the last one ends the threads. Calls throw Error (usage), too,
// where they would wait for ever: those that change the state or wait for it in the function that
// is the detector, and all in a forked process, which has no copy of the threads.
class SlamObject {
 public:
  // `options`: those of a run. `mounting`: R_camera_rectified of the source as (4, 4), or None.
  // `imu`: an alidade.Imu, or None.
  SlamObject(const py::object& camera, const py::dict& options, const py::object& mounting,
             bool calibrate, const py::object& imu);

  TrackedFrame Track(double time, const py::object& image, const py::object& depth,
                     const py::object& right, const py::object& color, const py::object& imu,
                     const std::string& stamp);
  void Load(const MapHolder& map);
  void LeaveOut(const py::object& mask);
  void Reset();
  void Forget();
  void SetMapping(bool on);
  void Finish(double limit);
  std::string View(int port, const std::string& host);
  void Record(const std::string& path);
  void EndRecord();
  void Close();
  bool closed() const { return held_ == nullptr; }

  py::object camera() const;
  py::object focal_sigma() const;
  py::dict settings() const;
  int frames() const;
  py::array_t<double> Trajectory(size_t number, bool live) const;
  std::string TrajectoryText(size_t number) const;
  py::list Frames(int since) const;
  MapHolder Map() const;
  py::object Health() const;
  py::object Inertial() const;
  py::dict Counts() const;
  py::dict Times() const;
  py::tuple Features() const;
  py::object MoverMask() const;
  py::object Detections() const;

 private:
  // Destroyed without the GIL, because a detector's thread may wait for it.
  struct Held {
    Held(const Camera& camera, const Eigen::Matrix3d& R_rectified, const SlamSettings& used,
         std::shared_ptr<Detector> detector, const SlamViewOptions& seen_as)
        : R_camera_rectified(R_rectified),
          settings(used),
          process(getpid()),
          own_detector(detector.get()),
          slam(camera, used, std::move(detector)),
          view(slam, seen_as),
          has_threads(used.threaded) {}
    std::mutex turn;  // serializes Track(), so that stamps and frames correspond
    RunLog log;       // stamps and numbers, for ResultsOf()
    const Eigen::Matrix3d R_camera_rectified;
    const SlamSettings settings;
    const pid_t process;                 // that has the threads
    const Detector* const own_detector;  // null: none
    Slam slam;
    SlamView view;                  // under `turn`
    std::atomic<bool> has_threads;  // its own, or those of viewer or recorder
    bool IsForked() const { return has_threads && process != getpid(); }
  };
  static void Delete(Held* held);
  std::shared_ptr<Held> Get() const;  // throws Error (usage) after Close() and in a forked process
  std::shared_ptr<Held> GetTurn() const;  // also in the detector's function
  MapResults ResultsOfMap(size_t number) const;

  std::shared_ptr<Held> held_;
};

}  // namespace alidade::python
