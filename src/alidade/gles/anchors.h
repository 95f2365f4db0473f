// Poses of keyframes in a texture, one slot each. Vertices store a slot and a position in that
// slot's keyframe. When keyframes move (loop closure, map adjustment), only their poses are
// uploaded, not the points, edges and paths.
#pragma once

#include <GLES3/gl3.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "alidade/gles/gpu_array.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

inline constexpr uint32_t kNowhere = 0;     // a slot whose content is hidden
inline constexpr uint32_t kCameraSlot = 1;  // the last frame's camera

// Four texels: the three rows of M in p_world = M * (p, 1); then log(least inverse depth), log(most
// / least), strength (0 hidden, 1 in the active map, 2 in another), 1 / scale.
struct Anchor {
  float rows[3][4] = {};
  float depth_least = 0, depth_span = 0, strength = 0, per_scale = 1;
};

// GLSL functions: Place(slot, p, strength) returns world coordinates, Range(slot) the fourth texel.
extern const char* const kAnchorsGlsl;

class Anchors {
 public:
  Anchors();
  // Assigns slots to all keyframes of the scene and sets their poses. Slots of removed keyframes
  // may be reused, so callers must look up their slots again before drawing.
  void Update(const StreamScene& scene, MapId active);
  void SetCamera(const Se3& T_world_camera, bool shown);
  uint32_t SlotOf(KeyFrameId id) const;  // kNowhere: unknown keyframe

  // Uploads changes and binds the texture to the active unit. Returns the number of uploaded bytes.
  size_t Bind();
  void Forget() { texture_ = 0, rows_ = 0; }
  void Release();

 private:
  void Put(uint32_t slot, const Anchor& anchor);
  std::unordered_map<uint32_t, uint32_t> slots_;  // by keyframe
  std::vector<uint32_t> unused_;
  std::vector<Anchor> anchors_;
  ChangedPages changed_{32};
  GLuint texture_ = 0;
  size_t rows_ = 0;  // of the texture
};

}  // namespace alidade::gles
