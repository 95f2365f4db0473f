// The path, and the frusta of keyframes and camera. OpenGL ES promises lines of one pixel only, so
// each is two triangles, as wide on the screen as is asked for, with soft edges.
#pragma once

#include <cstdint>
#include <vector>

#include "alidade/gles/anchors.h"
#include "alidade/gles/gl_program.h"
#include "alidade/gles/gpu_array.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

// From frame to frame, where both are known and in one map.
class PathLayer {
 public:
  PathLayer();
  // `anew`: the map is other than it was, so that frames may hang on other keyframes; else only
  // frames that came are added.
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
  size_t done_ = 0, used_ = 0;  // frames of the path, segments made of them
  bool joined_ = false;         // the last frame done can be gone on from
  End last_{};
  MapId last_map_;
  GLuint layout_ = 0;
};

// Each frustum is an instance that knows its slot and nothing else.
class FrustumLayer {
 public:
  FrustumLayer();
  void Update(const StreamScene& scene, const Anchors& anchors);
  // `deep`: the frustum of a keyframe, world units. The camera's own is drawn when it has a place,
  // twice as large.
  size_t Draw(const ViewSettings& view, double deep, bool lost, int width, int height);
  size_t count() const { return slots_.size(); }
  void Forget();
  void Release();

 private:
  void DrawSome(const Color& color, double deep, GLsizei count);
  GlProgram program_;
  GpuArray<uint32_t> slots_;        // of keyframes
  GpuArray<uint32_t> camera_slot_;  // one
  float corners_[4][2] = {};        // of the picture, at depth 1
  GLuint layout_ = 0, camera_layout_ = 0;
};

}  // namespace alidade::gles
