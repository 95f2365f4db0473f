// The trajectory. The pose of every frame is stored relative to a keyframe, so it follows later
// corrections of that keyframe. One thread writes; any other may read the trajectory meanwhile.
//
// Frames are stored in chunks of 512, 128 bytes each: 14 MB per hour at 30 frames per second. Full
// chunks are immutable and shared with readers; a change replaces a chunk. With a ByteStore, chunks
// older than the newest few are there, and memory does not grow with the number of frames.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "alidade/base/byte_store.h"
#include "alidade/map/anchor.h"
#include "alidade/map/id_table.h"
#include "alidade/map/map_store.h"
#include "alidade/system/settings.h"
#include "alidade/system/types.h"

namespace alidade {

class FrameLog {
 public:
  explicit FrameLog(const TrajectorySettings& settings = {});

  // Chunks that become old from now on go there. Writer only.
  void KeepIn(std::shared_ptr<ByteStore> store) { store_ = std::move(store); }

  // For each frame the writer calls Begin(), Place() if the frame has a pose, and End(). The frame
  // can be read after End(). Begin() ends the previous frame.
  void Begin(double time);  // seconds
  void BeginRecording();    // the next frames belong to the next FramePose::recording
  void Place(const Anchor& anchor, const Se3& T_world_camera_live);
  // Gives a finished frame, by its index, a pose or another pose. Does nothing if the frame is no
  // longer held.
  void PlaceLate(int index, Anchor anchor);
  void End();  // if it throws (out of memory), the next Begin() ends the frame
  bool empty() const { return size() == 0; }
  // The current FramePose::recording. Writer only.
  int recording() const { return static_cast<int>(recordings_.size()); }
  // Frames begun so far, including those no longer held.
  int size() const { return first_of_open_ + open_count_ + (begun_ ? 1 : 0); }
  double time() const { return time_; }                     // of the frame begun last, seconds
  const Se3& T_world_camera_live() const { return live_; }  // of the frame placed last

  // Poses relative to a keyframe that is culled in `map` become relative to its nearest live
  // ancestor in the spanning tree (Reanchored()). They change by rounding only. Afterwards no frame
  // needs a keyframe culled in `map`. Writer only.
  void Reanchor(const MapSnapshot& map);
  std::vector<KeyFrameId> Anchors() const;  // keyframes that poses are relative to; writer only

  // Finished frames from index `since` on, with poses in the current map. A frame whose map was
  // dropped has none. Any thread; the writer waits at most while a few pointers are copied. Throws
  // Error (input) if the ByteStore cannot be read.
  std::vector<FramePose> Trajectory(const MapStore& map, int since = 0) const;
  // Frames no longer held because of their age (TrajectorySettings::keep_seconds). Any thread.
  LetGoFrames let_go() const;
  size_t bytes() const;  // memory used by all frames; any thread

 private:
  static constexpr int kChunk = 512;  // frames
  // Full chunks that stay in memory: what Relocalizer and ReattachFrames() read, 3600 frames.
  static constexpr size_t kInMemory = 8;
  using Pose = std::array<double, 7>;  // quaternion (x, y, z, w), translation: 56 bytes, an Se3 96
  struct Record {
    double time = 0;
    Pose T_camera_placed = {0, 0, 0, 1};  // translation for a keyframe of scale 1
    Pose T_world_camera_live = {0, 0, 0, 1};
    KeyFrameId placed;  // the keyframe that the pose was relative to at first; invalid: no pose
    uint32_t late = 0;  // 1: first pose by PlaceLate(); T_world_camera_live is undefined
  };
  // Where a keyframe is that poses were relative to at first: itself, or once it was culled its
  // former pose relative to a live one.
  struct Placed {
    KeyFrameId id;
    KeyFrameId keyframe;    // the keyframe that moves it now; invalid: the map was dropped
    Se3 T_placed_keyframe;  // translation for a `keyframe` of scale 1
    double scale = 1;       // scale of `id` relative to that of `keyframe`
  };
  using Records = std::array<Record, kChunk>;
  struct Chunk {
    std::shared_ptr<const Records> records;          // null: in `stored`
    std::shared_ptr<const ByteStore::Piece> stored;  // null: in `records`
    double age = 0;                                  // recording time up to its last frame, seconds
    int tracked = 0;                                 // frames with a pose
  };

  void Seal();
  void Store(Chunk& chunk) const;
  static std::shared_ptr<const Records> RecordsOf(const Chunk& chunk);
  void Use(KeyFrameId keyframe, int chunk);
  void ForgetPlacedBefore(int chunk);
  static Pose Pack(const Se3& pose);
  static Se3 Unpack(const Pose& pose);

  TrajectorySettings settings_;
  // The frame between Begin() and End().
  bool begun_ = false, placed_now_ = false;
  double time_ = 0, age_ = 0;
  Anchor anchor_;
  Se3 live_;
  std::shared_ptr<Records> writing_;  // records of the open chunk
  std::shared_ptr<ByteStore> store_;
  std::map<KeyFrameId, int> last_use_;  // number of the last chunk with poses placed by it
  std::map<KeyFrameId, std::vector<KeyFrameId>> moves_;  // Placed::id by Placed::keyframe
  uint64_t version_ = 0;                                 // of placed_

  // Guards the members below: readers copy them, only the writer changes them.
  mutable std::mutex mutex_;
  std::shared_ptr<const std::vector<Chunk>> full_;
  int first_chunk_ = 0;  // number of the first chunk in full_
  IdTable<Placed> placed_;
  Chunk open_;
  int first_of_open_ = 0, open_count_ = 0;  // index of its first frame, number of frames
  LetGoFrames let_go_;
  std::vector<int> recordings_;  // index of the first frame of each recording but the first
};

}  // namespace alidade
