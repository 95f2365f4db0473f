// Serialization of a map (map.alidade) to and from bytes; no file access. The format is map.fbs.
// Equal maps give equal bytes.
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

// Contents of a map file. Images are not saved, so the frames of a loaded map have none.
struct SavedMap {
  MapSnapshot map;     // MapStore::Restore() continues with it; ids are kept
  Camera camera;       // camera of the keypoints: after rectification and scaling
  std::string sensor;  // "mono", "stereo" or "rgbd"
  std::vector<std::pair<std::string, std::string>> settings;  // names and values
  SavedPlaces places = {};  // for PlaceIndex::Restore(), with the keyframes of all maps
  uint32_t version = 0;     // format version it was read from; EncodeMap() always writes the newest
};

// Whether lengths of one of its maps are meters: by its sensor, or by what is known of its world.
inline bool InMeters(const SavedMap& saved, MapId map) {
  const MapWorld* world = saved.map.WorldOf(map);
  return saved.sensor != "mono" || (world && world->meters);
}

// Encodes live objects only: no records of culled keyframes or fused landmarks. The result is
// decoded once as a check before it is returned. Throws Error (input) if it exceeds the format's
// limit (2 GB), std::logic_error if the check fails (a bug).
std::string EncodeMap(const SavedMap& saved);

// Throws Error (input) if a file that begins with `start` is not a map. Checked before reading the
// whole file.
void CheckMapStart(std::string_view start);

// Throws Error (input) saying what is wrong if the bytes are not a map, are damaged, or were
// written by a newer version.
SavedMap DecodeMap(std::string_view bytes);

// Throws Error (input) naming the differences if `now` is not the camera of a map built with
// `saved`: another image size; a displacement of at least 0.5 pixels by focal lengths, principal
// point and distortion together; or a depth scale (baseline, depth_factor where both have one) that
// differs by at least 0.5 %. Files of one calibration differ by rounding only, repeated
// calibrations of one camera often by more: the message says what to do.
inline constexpr double kSameCamera = 0.5;  // pixels
void CheckSameCamera(const Camera& saved, const Camera& now);

// Whether two cameras of maps without depth may be calibrations of one camera. The pixels of one
// direction differ by no more than 0.5 pixels + 3 sqrt(sa² + sb²) r, at most 3 % of r, with their
// Camera::focal_sigma sa and sb and half the image's diagonal r; a sigma of 0 counts as the
// other's. Their mean difference, another principal point, is left out: it is nearly a rotation,
// and hardly determined by images. It may be 3 % of r. False if neither has a sigma.
bool MayBeOneCamera(const Camera& a, const Camera& b);
// Largest distance of the two cameras' pixels of one direction; infinite for different image sizes.
double CameraShift(const Camera& a, const Camera& b);

}  // namespace alidade
