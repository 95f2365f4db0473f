// A map as bytes (map.alidade) and back. No files here: the portable core has none.
// The format is map.fbs; equal maps give equal bytes.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "alidade/base/api.h"
#include "alidade/geometry/camera.h"
#include "alidade/map/map_store.h"
#include "alidade/place/place_index.h"

namespace ALIDADE_API alidade {

// All that is saved. Images are not: the frames of a map read back have none.
struct SavedMap {
  MapSnapshot map;     // MapStore::Restore() makes it the map to go on with; ids are kept
  Camera camera;       // that of the keypoints: after rectifying and scaling
  std::string sensor;  // "mono", "stereo" or "rgbd"
  std::vector<std::pair<std::string, std::string>> settings;  // name and value
  SavedPlaces places = {};  // for PlaceIndex::Restore(), with the keyframes of all maps
  uint32_t version = 0;     // of the format it was read from; it is always written in the newest
};

// Only what is alive: keyframes that were culled and landmarks that were fused are not in it. What
// is written was read again before it is returned. Throws Error (input) when it is larger than a
// file can be (2 GB), std::logic_error when it could not be read (a bug of ours).
std::string EncodeMap(const SavedMap& saved);

// Throws Error (input) when a file that begins like this is no map. A look at it before a sparse
// file of 2 GB is read.
void CheckMapStart(std::string_view start);

// Throws Error (input) that says what is wrong when these are not the bytes of a map, when they are
// damaged, or when they come from a newer program.
SavedMap DecodeMap(std::string_view bytes);

// Throws Error (input) naming what differs when `now` cannot go on in a map made by `saved`:
// another image size, a point seen half a pixel elsewhere or more by focal lengths, principal point
// and distortion together, or depth (baseline, depth_factor where both have one) off by 0.5 % or
// more. Files of the same calibration differ by rounding, calibrations of one camera often by more.
void CheckSameCamera(const Camera& saved, const Camera& now);

}  // namespace alidade
