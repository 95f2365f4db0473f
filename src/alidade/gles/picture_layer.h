// Draws the camera image upright, fitted into its area, with the last frame's features.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "alidade/gles/gl_program.h"
#include "alidade/gles/gpu_array.h"
#include "alidade/gles/view.h"
#include "alidade/stream/stream_scene.h"

namespace alidade::gles {

// Pixels of the screen, from the lower left corner as in OpenGL.
struct PixelArea {
  int left = 0, bottom = 0, width = 0, height = 0;
  bool none() const { return width <= 0 || height <= 0; }
};
PixelArea PixelsOf(const Area& area, int width, int height);

// The largest centered area within `area` for an image of this size rotated clockwise by 0, 90, 180
// or 270 degrees.
PixelArea FitPicture(const PixelArea& area, int width, int height, int rotation);

class PictureLayer {
 public:
  PictureLayer();
  // Any thread. Copies the image. Throws Error (usage) for invalid arguments.
  void Set(const uint8_t* luma, int width, int height, size_t stride, int rotation);
  void Update(const StreamScene& scene);
  // Sets the viewport to the part of `area` that the image covers.
  size_t Draw(const ViewSettings& view, const PixelArea& area);
  bool any() const { return !shown_.pixels.empty(); }
  void Forget();
  void Release();

 private:
  struct Plane {
    std::vector<uint8_t> pixels;  // rows without padding
    int width = 0, height = 0, rotation = 0;
  };
  struct Vertex {
    float x, y;  // shares of the image's width and height
    uint32_t use;
  };
  size_t Upload();
  void DrawFeatures(const ViewSettings& view);

  std::mutex mutex_;  // guards next_ and fresh_
  Plane next_;
  bool fresh_ = false;
  Plane shown_;
  bool uploaded_ = false;
  GlProgram program_, feature_program_;
  GpuArray<Vertex> features_;
  GLuint texture_ = 0, layout_ = 0, feature_layout_ = 0;
  int texture_width_ = 0, texture_height_ = 0;
};

}  // namespace alidade::gles
