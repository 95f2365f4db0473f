// Interface of the drawing code: the OpenGL ES renderer (src/alidade/gles), or a dummy when it was
// not built.
#pragma once

#include <cstdint>
#include <memory>

#include "alidade/stream/stream_scene.h"

namespace alidade {

struct ViewFrame {
  const StreamScene* scene = nullptr;
  const uint8_t* luma = nullptr;  // an image not drawn yet, rows without padding; or null
  int width = 0, height = 0;      // of the image, pixels
  int rotation = 0;               // clockwise degrees that make images upright
};

// Screen's thread only. Draw() and Release() require a current GL context.
class SceneView {
 public:
  virtual ~SceneView() = default;
  virtual void Resize(int width, int height) = 0;
  // Draws image and map side by side along the longer side of the surface.
  virtual void Draw(const ViewFrame& frame) = 0;
  // A drag in pixels; a pinch (above 1: apart).
  virtual void Turn(double right, double down) = 0;
  virtual void Zoom(double factor) = 0;
  // The context is new; objects of the previous one are lost.
  virtual void ContextLost() = 0;
  virtual void Release() = 0;  // before the context is left
};

std::unique_ptr<SceneView> MakeSceneView();

}  // namespace alidade
