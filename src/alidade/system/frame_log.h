// Where every frame is, told by the keyframe it was placed against: what is learnt of that later
// moves the frame along. One thread writes; any other may ask for the trajectory meanwhile.
//
// Frames lie in chunks of 512 that never change once full; readers share them. A frame takes 128
// bytes, its share of the chunk's table of keyframes some 20: 16 MB an hour at 30 per second.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "alidade/map/anchor.h"
#include "alidade/map/map_store.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace alidade {

class FrameLog {
 public:
  explicit FrameLog(const TrajectorySettings& settings = {});

  // The writer's: Begin, Place when the frame has a pose, End. A frame that was begun is readable
  // once it has ended; Begin ends the one before.
  void Begin(double time);  // seconds
  void BeginRecording();    // frames begun from now on are the next one's (FramePose::recording)
  void Place(const Anchor& anchor, const Se3& T_world_camera_live);
  // A frame that has ended, by its index, gets the pose it lacked or another one. Nothing happens
  // to one that was let go.
  void PlaceLate(int index, Anchor anchor);
  void End();  // where it throws, for want of memory, the next Begin ends the frame
  bool empty() const { return size() == 0; }
  int recording() const { return static_cast<int>(recordings_.size()); }  // the writer's, of now
  int size() const { return first_of_open_ + open_count_ + (begun_ ? 1 : 0); }  // frames begun
  double time() const { return time_; }                     // of the frame begun last
  const Se3& T_world_camera_live() const { return live_; }  // of the frame placed last

  // Frames placed against a keyframe that is culled in `map` are tied to the living keyframe it
  // follows instead, where they stay to within rounding. From then on no frame needs a culled
  // keyframe of `map`. The writer's.
  void Reanchor(const MapSnapshot& map);
  std::vector<KeyFrameId> Anchors() const;  // keyframes that frames hang on. The writer's

  // Frames that have ended, from index `since` on, by the map as it is now; those whose map is gone
  // have no pose. Any thread's; the writer waits for it no longer than it takes to copy a few
  // pointers.
  std::vector<FramePose> Trajectory(const MapStore& map, int since = 0) const;
  // Frames that were let go (TrajectorySettings::keep_seconds). Any thread's.
  LetGoFrames let_go() const;
  size_t bytes() const;  // that all frames take. Any thread's

 private:
  static constexpr int kChunk = 512;  // frames
  struct Pose {                       // as Se3, in 56 bytes instead of 96
    Eigen::Quaternion<double, Eigen::DontAlign> q{1, 0, 0, 0};
    Eigen::Vector3d t{0, 0, 0};
  };
  struct Record {
    double time = 0;
    Pose T_camera_anchor;  // with lengths as if the anchor's scale were 1
    Pose T_world_camera_live;
    int anchor = -1;    // in the chunk's table; -1: no pose
    bool late = false;  // it had none when the frame was done: there is no live one
  };
  // What records are tied to: a keyframe, or the place one had beside an older one.
  struct ChunkAnchor {
    KeyFrameId placed;      // the keyframe records were placed against
    KeyFrameId keyframe;    // the one that tells now where it is; none: their map is gone
    Se3 T_placed_keyframe;  // with lengths as if the keyframe's scale were 1
    double scale = 1;       // of `placed`, relative to the keyframe's
  };
  using Records = std::array<Record, kChunk>;
  using AnchorTable = std::vector<ChunkAnchor>;
  struct Chunk {
    std::shared_ptr<const Records> records;
    std::shared_ptr<const AnchorTable> anchors;
    double age = 0;   // seconds of recording up to its last frame
    int tracked = 0;  // frames
  };

  void Seal();
  int AnchorOf(KeyFrameId keyframe);
  int AnchorIn(std::shared_ptr<const AnchorTable>& table, int number, KeyFrameId keyframe);
  static Pose Pack(const Se3& pose) { return {pose.Quaternion(), pose.t}; }
  static Se3 Unpack(const Pose& pose) { return {pose.q.toRotationMatrix(), pose.t}; }

  TrajectorySettings settings_;
  // The frame that was begun.
  bool begun_ = false, placed_ = false;
  double time_ = 0, age_ = 0;
  Anchor anchor_;
  Se3 live_;
  std::shared_ptr<Records> writing_;  // the open chunk's
  // In which chunks (by number) a keyframe is an anchor.
  std::map<KeyFrameId, std::vector<int>> chunks_of_;

  mutable std::mutex mutex_;  // of all below, where a reader may be; only the writer changes them
  std::shared_ptr<const std::vector<Chunk>> full_;
  int first_chunk_ = 0;  // number of the first in full_
  Chunk open_;
  int first_of_open_ = 0, open_count_ = 0;  // frames
  LetGoFrames let_go_;
  std::vector<int> recordings_;  // index of the first frame of each but the first
};

}  // namespace alidade
