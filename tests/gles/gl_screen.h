// An OpenGL ES 3 context without a window (EGL with Mesa's software renderer), and screenshots.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "alidade/gles/view.h"

namespace alidade::gles_test {

using Pixel = std::array<uint8_t, 4>;

// Rows from the top.
struct Shot {
  int width = 0, height = 0;
  std::vector<Pixel> pixels;
  const Pixel& At(int x, int y) const {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
  bool Has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  bool operator==(const Shot&) const = default;
};

inline Pixel PixelOf(const gles::Color& color) {
  const auto byte = [](float value) { return static_cast<uint8_t>(std::lround(255 * value)); };
  return {byte(color[0]), byte(color[1]), byte(color[2]), 255};
}
// Largest difference of a channel.
inline int Difference(const Pixel& a, const Pixel& b) {
  int most = 0;
  for (size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

class GlContext {
 public:
  GlContext() {
    setenv("EGL_LOG_LEVEL", "fatal", 0);
    const auto get = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (!get) return;
    display_ = get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) return;
    eglBindAPI(EGL_OPENGL_ES_API);
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT, EGL_NONE};
    EGLint found = 0;
    if (!eglChooseConfig(display_, wanted, &config_, 1, &found) || found == 0) return;
    Make();
  }
  ~GlContext() { Destroy(); }
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  bool ok() const { return context_ != EGL_NO_CONTEXT; }
  void Destroy() {
    if (!ok()) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    context_ = EGL_NO_CONTEXT;
  }
  void Make() {
    const EGLint version[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    context_ = eglCreateContext(display_, config_, EGL_NO_CONTEXT, version);
    if (ok() && !eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) Destroy();
  }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLConfig config_ = nullptr;
  EGLContext context_ = EGL_NO_CONTEXT;
};

// A framebuffer with color and depth, like a window's.
class GlScreen {
 public:
  GlScreen(int width, int height) : width_(width), height_(height) {
    glGenRenderbuffers(2, buffers_);
    glGenFramebuffers(1, &frame_);
    glBindFramebuffer(GL_FRAMEBUFFER, frame_);
    const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT24};
    const GLenum places[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, buffers_[i]);
      glRenderbufferStorage(GL_RENDERBUFFER, formats[i], width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers_[i]);
    }
    EXPECT_EQ(glCheckFramebufferStatus(GL_FRAMEBUFFER),
              static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
  }
  ~GlScreen() {
    glDeleteFramebuffers(1, &frame_);
    glDeleteRenderbuffers(2, buffers_);
  }
  GlScreen(const GlScreen&) = delete;
  GlScreen& operator=(const GlScreen&) = delete;

  Shot Take() const {
    Shot shot{width_, height_, {}};
    const auto w = static_cast<size_t>(width_), h = static_cast<size_t>(height_);
    std::vector<Pixel> upside_down(w * h);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.data());
    shot.pixels.reserve(w * h);
    for (size_t y = h; y-- > 0;) {
      const auto row = upside_down.begin() + static_cast<std::ptrdiff_t>(y * w);
      shot.pixels.insert(shot.pixels.end(), row, row + static_cast<std::ptrdiff_t>(w));
    }
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
    return shot;
  }

 private:
  int width_, height_;
  GLuint frame_ = 0, buffers_[2] = {};
};

// Skips the test when no such context is available.
class GlTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!context.ok()) GTEST_SKIP() << "no OpenGL ES 3 without a window here (Mesa's EGL)";
  }
  GlContext context;
};

}  // namespace alidade::gles_test
