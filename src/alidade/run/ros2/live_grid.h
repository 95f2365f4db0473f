// A floor grid that follows a run: keyframes' depth, fused again where the map was corrected.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "alidade/run/play/watcher.h"
#include "alidade/surface/dense_view.h"
#include "alidade/surface/floor.h"
#include "alidade/surface/occupancy.h"

namespace alidade {

struct LiveGridSettings {
  OccupancySettings occupancy;
  double period = 2;     // seconds between two grids, at least
  int most_width = 160;  // of the depth images that are kept, pixels: 77 kB at 160 x 120
};

class LiveGrid {
 public:
  // `T_map_floor`: the floor's frame with z up, as nav_msgs/OccupancyGrid's origin without the
  // corner of the grid.
  using Tell = std::function<void(const OccupancyPicture& picture, const Se3& T_map_floor)>;

  // `T_map_world`: of the camera as mounted (RobotFrames), with z of the map upward. `tell` is
  // called in a thread of this object. Throws Error (usage) for one camera. `run` must outlive this
  // object.
  LiveGrid(const LiveGridSettings& settings, const WatchedRun& run, const Se3& T_map_world,
           Tell tell);
  ~LiveGrid();
  LiveGrid(const LiveGrid&) = delete;
  LiveGrid& operator=(const LiveGrid&) = delete;

  // After each frame that Track() has processed.
  void Add(const SourceFrame& frame, const TrackResult& result);

 private:
  struct Waiting {
    int number = 0;          // Frame::number
    cv::Mat image, partner;  // depth, or the images of a pair
  };
  struct Kept {
    DenseView view;
    std::optional<Se3> used;  // T_map_camera by which it is in the grid
  };
  void Work();
  DenseView ViewOf(const Waiting& waiting) const;
  // Poses of the kept views as they are now; those of other maps and of culled keyframes go.
  void Place(const MapSnapshot& map);
  bool FindTheFloor();  // by the kept views; false: there is none yet
  void Fuse();

  const LiveGridSettings settings_;
  const Slam& slam_;
  const SourceInfo source_;
  const Se3 T_map_view_world_;  // from the world of the rectified camera
  const Tell tell_;
  // Used by the thread only.
  std::map<int, Kept> kept_;  // by Frame::number
  std::optional<Se3> T_map_floor_;
  std::unique_ptr<OccupancyMap> grid_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Waiting> waiting_;  // guarded by mutex_
  bool ends_ = false;             // likewise
  std::thread thread_;            // last, because it uses the other members
};

}  // namespace alidade
