#include "alidade/gles/renderer.h"

#include <GLES3/gl3.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "alidade/base/error.h"
#include "alidade/gles/anchors.h"
#include "alidade/gles/extent.h"
#include "alidade/gles/line_layers.h"
#include "alidade/gles/picture_layer.h"
#include "alidade/gles/point_layers.h"

namespace alidade::gles {

struct Renderer::Layers {
  Anchors anchors;
  LandmarkLayer landmarks;
  CloudLayer points;
  PathLayer path;
  FrustumLayer frusta;
  PictureLayer picture;

  size_t DrawMap(const ViewSettings& view, const PixelArea& area, double frustum, bool lost) {
    glViewport(area.left, area.bottom, area.width, area.height);
    glScissor(area.left, area.bottom, area.width, area.height);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    size_t uploaded = anchors.Bind();
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    if (view.points) uploaded += points.Draw(view, area.width, area.height);
    if (view.landmarks) uploaded += landmarks.Draw(view, area.width, area.height);
    // Soft-edged lines are occluded by points, but not by each other's edges.
    glEnable(GL_BLEND);
    glDepthMask(GL_FALSE);
    if (view.path) uploaded += path.Draw(view, area.width, area.height);
    if (view.keyframes || view.camera)
      uploaded += frusta.Draw(view, frustum, lost, area.width, area.height);
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    return uploaded;
  }
};

Renderer::Renderer() : layers_(std::make_unique<Layers>()) {}
Renderer::~Renderer() = default;

void Renderer::Resize(int width, int height) {
  if (width < 1 || height < 1)
    ThrowUsage("nothing can be drawn on " + std::to_string(width) + " x " + std::to_string(height) +
               " pixels");
  width_ = width;
  height_ = height;
}

void Renderer::SetCameraPicture(const uint8_t* luma, int width, int height, size_t stride,
                                int rotation) {
  layers_->picture.Set(luma, width, height, stride, rotation);
}

void Renderer::Show(const StreamScene& scene) {
  Layers& layers = *layers_;
  // May change without a change of the map, when the camera is relocalized in another one.
  const MapId active = scene.ActiveMap();
  const bool anew = scene.told != told_ || active != active_;
  if (anew) {
    layers.anchors.Update(scene, active);
    layers.landmarks.Update(scene, layers.anchors);
    layers.points.Update(scene, layers.anchors);
    layers.frusta.Update(scene, layers.anchors);
    frustum_ = 0.05 * TypicalDistance(scene);
    told_ = scene.told;
    active_ = active;
  }
  layers.path.Update(scene, layers.anchors, anew);
  layers.picture.Update(scene);
  const std::optional<Se3> camera = scene.CameraPose();
  layers.anchors.SetCamera(camera.value_or(Se3()), camera.has_value());
  lost_ = scene.now.T_world_guess.has_value();
}

DrawStats Renderer::Draw(const ViewSettings& view) {
  view.Check();
  // Discard errors from before this call; limited, because some drivers report a lost context for
  // ever.
  for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {
  }
  GLint most[2] = {1, 1};
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, most);
  const int width = std::min(width_, std::max(most[0], 1));
  const int height = std::min(height_, std::max(most[1], 1));

  const Color& ground = view.colors.background;
  glClearColor(ground[0], ground[1], ground[2], 1);
  glClearDepthf(1);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  for (GLenum off : {GL_CULL_FACE, GL_STENCIL_TEST, GL_DEPTH_TEST, GL_RASTERIZER_DISCARD})
    glDisable(off);
  glBlendEquation(GL_FUNC_ADD);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glPixelStorei(GL_UNPACK_SKIP_ROWS, 0);
  glPixelStorei(GL_UNPACK_SKIP_PIXELS, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glActiveTexture(GL_TEXTURE0);
  glBindSampler(0, 0);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, width, height);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

  DrawStats stats;
  const PixelArea map = PixelsOf(view.map, width, height);
  const PixelArea picture = PixelsOf(view.picture, width, height);
  const auto draw_map = [&] {
    if (map.none()) return;
    const double frustum = view.frustum > 0 ? view.frustum : frustum_;
    stats.uploaded += layers_->DrawMap(view, map, frustum, lost_);
  };
  const auto draw_picture = [&] {
    if (!picture.none()) stats.uploaded += layers_->picture.Draw(view, picture);
  };
  const auto size = [](const Area& area) { return area.width * area.height; };
  if (size(view.map) < size(view.picture)) {
    draw_picture();
    draw_map();
  } else {
    draw_map();
    draw_picture();
  }
  glDisable(GL_SCISSOR_TEST);
  glBindVertexArray(0);
  stats.landmarks = layers_->landmarks.count();
  stats.points = layers_->points.count();
  stats.segments = layers_->path.count();
  stats.keyframes = layers_->frusta.count();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    char text[80];
    std::snprintf(text, sizeof text, "OpenGL ES reports error 0x%04x%s", error,
                  error == GL_OUT_OF_MEMORY ? " (out of memory)" : "");
    ThrowInput(text);
  }
  return stats;
}

void Renderer::ContextLost() {
  Layers& layers = *layers_;
  layers.anchors.Forget();
  layers.landmarks.Forget();
  layers.points.Forget();
  layers.path.Forget();
  layers.frusta.Forget();
  layers.picture.Forget();
}

void Renderer::Release() {
  Layers& layers = *layers_;
  layers.anchors.Release();
  layers.landmarks.Release();
  layers.points.Release();
  layers.path.Release();
  layers.frusta.Release();
  layers.picture.Release();
}

}  // namespace alidade::gles
