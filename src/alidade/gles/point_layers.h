// Landmarks, and the semi-dense points of keyframes: one call each, whatever their number.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "alidade/gles/anchors.h"
#include "alidade/gles/gl_program.h"
#include "alidade/gles/gpu_array.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

class LandmarkLayer {
 public:
  LandmarkLayer();
  // Takes over what the scene's map has other than what is known; no GL call.
  void Update(const StreamScene& scene, const Anchors& anchors);
  // For a viewport of that many pixels. Bytes that were uploaded.
  size_t Draw(const ViewSettings& view, int width, int height);
  size_t count() const { return ids_.size(); }
  void Forget();
  void Release();

 private:
  struct Vertex {
    float x, y, z;  // in the keyframe
    uint32_t slot;
  };
  GlProgram program_;
  GpuArray<Vertex> vertices_;
  std::vector<std::pair<LandmarkId, uint32_t>> ids_;  // and where their vertices are; by id
  std::vector<uint32_t> unused_;
  GLuint layout_ = 0;
};

// A keyframe's points lie in blocks that may be anywhere; blocks of one that went are used again.
// Vertices are what the stream tells (8 bytes: place in the picture, inverse depth, colour) and a
// slot.
class CloudLayer {
 public:
  CloudLayer();
  void Update(const StreamScene& scene, const Anchors& anchors);
  size_t Draw(const ViewSettings& view, int width, int height);
  size_t count() const { return count_; }
  void Forget();
  void Release();

 private:
  static constexpr size_t kBlock = 256;  // points
  struct Vertex {
    uint16_t x, y, depth, color;
    uint32_t slot;
  };
  struct Cloud {
    uint64_t told = 0;  // SceneKeyFrame::depth_told
    size_t points = 0;
    std::vector<size_t> blocks;
  };
  void Hide(Cloud& cloud);
  void Show(const SceneKeyFrame& keyframe, uint32_t slot, Cloud& cloud);

  GlProgram program_;
  GpuArray<Vertex> vertices_;
  std::unordered_map<uint32_t, Cloud> clouds_;  // by keyframe
  std::vector<size_t> unused_;                  // blocks
  size_t count_ = 0;
  Camera camera_;
  GLuint layout_ = 0;
};

}  // namespace alidade::gles
