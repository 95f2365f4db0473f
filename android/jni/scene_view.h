// What is drawn with: the OpenGL ES renderer (src/alidade/gles), or nothing where it was not built.
#pragma once

#include <cstdint>
#include <memory>

#include "alidade/stream/stream_scene.h"

namespace alidade {

struct ViewFrame {
  const StreamScene* scene = nullptr;
  const uint8_t* luma = nullptr;  // a picture that was not drawn yet, rows without gaps; or null
  int width = 0, height = 0;      // of it, pixels
  int rotation = 0;               // degrees clockwise by which pictures are turned to stand upright
};

// The screen's thread alone. Draw() and Release() need the GL context to be current.
class SceneView {
 public:
  virtual ~SceneView() = default;
  virtual void Resize(int width, int height) = 0;
  // Picture and map side by side, along the longer side of the surface.
  virtual void Draw(const ViewFrame& frame) = 0;
  // A finger moved so many pixels; fingers went apart (above 1) or together.
  virtual void Turn(double right, double down) = 0;
  virtual void Zoom(double factor) = 0;
  // The context is new, and what was made in the one before is gone.
  virtual void ContextLost() = 0;
  virtual void Release() = 0;  // before the context is left
};

std::unique_ptr<SceneView> MakeSceneView();

}  // namespace alidade
