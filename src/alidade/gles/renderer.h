// Draws a scene of the stream and the camera's picture into whatever framebuffer is current, with
// OpenGL ES 3.0 and nothing else: no window, no context of its own, no library to load.
//
// One thread (that of the context) at a time, but for SetCameraPicture(). Only Draw() and Release()
// call OpenGL; the others may be called before there is a context, and after it was lost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "alidade/gles/view.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

// What the last Draw() did.
struct DrawStats {
  size_t uploaded = 0;                                            // bytes that went to the GPU
  size_t landmarks = 0, points = 0, segments = 0, keyframes = 0;  // there are
};

class Renderer {
 public:
  Renderer();
  // Names in the context stay: they go with it. Release() first when it lives on.
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Of the framebuffer, pixels; what is more than the context can do is cut to that when it is
  // drawn. Throws Error (usage) on sizes below 1.
  void Resize(int width, int height);

  // A picture of 8 bit grey, or the luma plane of one in colours, rows `stride` bytes apart; it is
  // shown turned clockwise by `rotation` degrees (0, 90, 180 or 270). Any thread; the bytes are
  // copied. Throws Error (usage) on what cannot be.
  void SetCameraPicture(const uint8_t* luma, int width, int height, size_t stride, int rotation);

  // Takes over what the scene has other than what was shown last. Costs what is new; when the map
  // has changed, a look at each keyframe and landmark (some ms for 100,000).
  void Show(const StreamScene& scene);

  // Everything, over all of the framebuffer. Sets all OpenGL state it needs and restores none of
  // it. Throws Error (usage) on settings that cannot be, and (input) when the context refuses the
  // shaders or reports an error, an exhausted memory for one.
  DrawStats Draw(const ViewSettings& view);

  // The context is gone, and all in it: the next Draw() builds everything anew. To be called
  // whenever a context is made (Android: onSurfaceCreated).
  void ContextLost();
  // Deletes what is in the context, which must be current. Draw() builds it anew.
  void Release();

 private:
  struct Layers;
  std::unique_ptr<Layers> layers_;
  int width_ = 1, height_ = 1;
  uint64_t told_ = 0;   // StreamScene::told of what was shown
  double frustum_ = 0;  // world units
  bool lost_ = false;
};

}  // namespace alidade::gles
