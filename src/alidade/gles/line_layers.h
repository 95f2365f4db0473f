// Draws the path and the frusta of the keyframes and the camera. OpenGL ES guarantees lines of one
// pixel only, so each line consists of two triangles with the requested width and soft edges.
#pragma once

#include <cstdint>
#include <vector>

#include "alidade/gles/anchors.h"
#include "alidade/gles/gl_program.h"
#include "alidade/gles/gpu_array.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

// Connects consecutive frames that both have a pose in the same map.
class PathLayer {
 public:
  PathLayer();
  // `anew`: the map changed, so frames may refer to other keyframes, and all segments are rebuilt.
  // Otherwise only new frames are added.
  void Update(const StreamScene& scene, const Anchors& anchors, bool anew);
  size_t Draw(const ViewSettings& view, int width, int height);
  size_t count() const { return segments_.size(); }
  void Forget();
  void Release();

 private:
  struct End {
    float x, y, z;  // in the keyframe
    uint32_t slot;
  };
  struct Segment {
    End from, to;
  };
  GlProgram program_;
  GpuArray<Segment> segments_;
  size_t done_ = 0, used_ = 0;  // frames processed, and segments made from them
  bool joined_ = false;         // the last processed frame can be continued
  End last_{};
  MapId last_map_;
  GLuint layout_ = 0;
};

// Each frustum is an instance whose only attribute is its slot.
class FrustumLayer {
 public:
  FrustumLayer();
  void Update(const StreamScene& scene, const Anchors& anchors);
  // `deep`: depth of a keyframe's frustum, world units. The camera's frustum is drawn if its pose
  // is known, twice as large.
  size_t Draw(const ViewSettings& view, double deep, bool lost, int width, int height);
  size_t count() const { return slots_.size(); }
  void Forget();
  void Release();

 private:
  void DrawSome(const Color& color, double deep, GLsizei count);
  GlProgram program_;
  GpuArray<uint32_t> slots_;        // of keyframes
  GpuArray<uint32_t> camera_slot_;  // one element
  float corners_[4][2] = {};        // of the image, at depth 1
  GLuint layout_ = 0, camera_layout_ = 0;
};

}  // namespace alidade::gles
