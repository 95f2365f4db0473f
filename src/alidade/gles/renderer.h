// Draws a stream scene and the camera image into the current framebuffer with OpenGL ES 3.0.
// Creates no window and no context, and needs no other library.
//
// Use from the context's thread only, except SetCameraPicture(). Only Draw() and Release() call
// OpenGL; the other methods may be called before a context exists and after it was lost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "alidade/gles/view.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

// Statistics of one Draw().
struct DrawStats {
  size_t uploaded = 0;                                            // bytes sent to the GPU
  size_t landmarks = 0, points = 0, segments = 0, keyframes = 0;  // totals
};

class Renderer {
 public:
  Renderer();
  // Does not delete OpenGL objects. Call Release() first if the context lives on.
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Size of the framebuffer in pixels; limited to the context's maximum when drawing. Throws Error
  // (usage) for sizes below 1.
  void Resize(int width, int height);

  // Sets the camera image: 8-bit gray, or the luma plane of a color image, with rows `stride` bytes
  // apart. It is shown rotated clockwise by `rotation` degrees (0, 90, 180 or 270). Any thread;
  // copies the bytes. Throws Error (usage) for invalid arguments.
  void SetCameraPicture(const uint8_t* luma, int width, int height, size_t stride, int rotation);

  // Applies the changes of the scene since the last call. The cost is proportional to the new
  // frames; when the map changed, it also visits every keyframe and landmark (a few milliseconds
  // for 100,000).
  void Show(const StreamScene& scene);

  // Draws over the whole framebuffer. Sets the OpenGL state it needs and does not restore it.
  // Throws Error (usage) for invalid settings, and Error (input) when the context rejects the
  // shaders or reports an error such as out of memory.
  DrawStats Draw(const ViewSettings& view);

  // Call whenever a new context replaces the old one (Android: onSurfaceCreated). The next Draw()
  // recreates all objects.
  void ContextLost();
  // Deletes all objects of the context, which must be current. Draw() recreates them.
  void Release();

 private:
  struct Layers;
  std::unique_ptr<Layers> layers_;
  int width_ = 1, height_ = 1;
  uint64_t told_ = 0;   // StreamScene::told of the scene shown last
  MapId active_;        // of the scene shown last
  double frustum_ = 0;  // world units
  bool lost_ = false;
};

}  // namespace alidade::gles
