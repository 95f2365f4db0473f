// Draws landmarks and the keyframes' semi-dense points, with one draw call each.
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
  // Applies the changes of the scene's map; makes no GL calls.
  void Update(const StreamScene& scene, const Anchors& anchors);
  // `width`, `height`: the viewport in pixels. Returns the number of uploaded bytes.
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
  // Landmarks and their vertex index, sorted by id.
  std::vector<std::pair<LandmarkId, uint32_t>> ids_;
  std::vector<uint32_t> unused_;
  GLuint layout_ = 0;
};

// A keyframe's points are stored in blocks anywhere in the buffer; blocks of removed keyframes are
// reused. A vertex holds the stream's 8 bytes (image position, inverse depth, color) and a slot.
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
