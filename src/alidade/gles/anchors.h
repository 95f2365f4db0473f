// Poses of keyframes in a texture, a slot each: what is drawn carries a slot and a place in that
// slot's keyframe. When keyframes move (a loop was closed, the map adjusted), their poses are
// uploaded, and no point, edge or path.
#pragma once

#include <GLES3/gl3.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "alidade/gles/gpu_array.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

inline constexpr uint32_t kNowhere = 0;     // a slot that is not drawn
inline constexpr uint32_t kCameraSlot = 1;  // the last frame's camera

// Four texels: the rows of a matrix, p_world = M * (p, 1), then the logarithm of the least inverse
// depth, that of most / least, the strength (0 hidden, 1 of the active map, 2 of another), 1 /
// scale.
struct Anchor {
  float rows[3][4] = {};
  float depth_least = 0, depth_span = 0, strength = 0, per_scale = 1;
};

// GLSL: Place(slot, p, strength) in the world, Range(slot) the fourth texel.
extern const char* const kAnchorsGlsl;

class Anchors {
 public:
  Anchors();
  // The slots of all keyframes in the scene, and their poses. Those of keyframes that went may be
  // given to others: whoever holds one must have looked them up again before anything is drawn.
  void Update(const StreamScene& scene, MapId active);
  void SetCamera(const Se3& T_world_camera, bool shown);
  uint32_t SlotOf(KeyFrameId id) const;  // kNowhere: not known

  // Uploads what was changed, binds the texture to the active unit. Bytes that were uploaded.
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
