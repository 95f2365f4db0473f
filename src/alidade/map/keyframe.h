// A frame the map remembers.
#pragma once

#include <memory>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/base/ids.h"
#include "alidade/features/frame.h"
#include "alidade/geometry/se3.h"
#include "alidade/map/depth_map.h"

namespace ALIDADE_API alidade {

struct Neighbour {
  KeyFrameId id;
  int shared = 0;  // landmarks both see
};

struct KeyFrame {
  KeyFrameId id;
  std::shared_ptr<const Frame> frame;  // never null in a map
  Se3 T_camera_world;
  MapId map;          // whose world the pose is in
  KeyFrameId parent;  // spanning tree; none for the first of a map. Always the older of the two
  // What lengths around it were multiplied by since its birth: loops of a monocular map correct the
  // scale.
  double scale = 1;
  std::vector<KeyFrameId> loops;          // keyframes a closed loop ties it to, sorted
  std::vector<LandmarkId> landmarks;      // one for each keypoint; none where nothing is known
  std::vector<Neighbour> covisible;       // most shared landmarks first, then by id
  std::shared_ptr<const DepthMap> depth;  // semi-dense; null: not (yet) known
  uint64_t version = 0;                   // commit that wrote it

  Eigen::Vector3d Centre() const { return T_camera_world.Inverse().t; }  // in the world
};

}  // namespace alidade
