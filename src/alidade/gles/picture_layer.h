// The camera's picture, turned upright and fitted into its area, with the last frame's features.
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

// In pixels of the screen, from its lower left corner, as OpenGL counts.
struct PixelArea {
  int left = 0, bottom = 0, width = 0, height = 0;
  bool none() const { return width <= 0 || height <= 0; }
};
PixelArea PixelsOf(const Area& area, int width, int height);

// Where a picture turned clockwise by 0, 90, 180 or 270 degrees lies when it is as large as fits
// into `area`, in its middle.
PixelArea FitPicture(const PixelArea& area, int width, int height, int rotation);

class PictureLayer {
 public:
  PictureLayer();
  // Any thread; copies the picture. Throws Error (usage) on what cannot be.
  void Set(const uint8_t* luma, int width, int height, size_t stride, int rotation);
  void Update(const StreamScene& scene);
  // Sets the viewport to what is left of `area` when the picture is fitted into it.
  size_t Draw(const ViewSettings& view, const PixelArea& area);
  bool any() const { return !shown_.pixels.empty(); }
  void Forget();
  void Release();

 private:
  struct Plane {
    std::vector<uint8_t> pixels;  // rows without gaps
    int width = 0, height = 0, rotation = 0;
  };
  struct Vertex {
    float x, y;  // shares of the picture's width and height
    uint32_t use;
  };
  size_t Upload();
  void DrawFeatures(const ViewSettings& view);

  std::mutex mutex_;  // of next_ and fresh_
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
