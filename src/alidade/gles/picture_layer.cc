#include "alidade/gles/picture_layer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/gles/eye.h"

namespace alidade::gles {
namespace {

// Maps positions in the image, as shares of width and height from the top left, to the screen.
constexpr const char* kTurnGlsl = R"(
uniform mat3 turn;
vec4 Turn(vec2 share) { return vec4((turn * vec3(share, 1.0)).xy, 0.0, 1.0); }
)";

constexpr const char* kPictureGlsl = R"(
out vec2 share;
void main() {
  share = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  gl_Position = Turn(share);
}
)";
constexpr const char* kLumaGlsl = R"(
uniform sampler2D luma;
in vec2 share;
out vec4 result;
void main() { result = vec4(texture(luma, share).rrr, 1.0); }
)";

// Values of `use`: 0 free, 1 matched, 2 fresh, 3 moving (stream.fbs).
constexpr const char* kFeatureGlsl = R"(
layout(location = 0) in vec2 place;
layout(location = 1) in uint use;
uniform vec3 inks[4];
uniform bool unmatched;
uniform float size;
out vec3 color;
void main() {
  gl_Position = use != 0u || unmatched ? Turn(place) : vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = size;
  color = inks[min(use, 3u)];
}
)";
constexpr const char* kDiscGlsl = R"(
uniform float size;
in vec3 color;
out vec4 result;
void main() {
  float outside = (length(gl_PointCoord - 0.5) - 0.5) * size;  // pixels
  result = vec4(color, clamp(0.5 - outside, 0.0, 1.0));
}
)";

bool IsAcross(int rotation) { return rotation == 90 || rotation == 270; }

// Columns of the matrix: for the share's x, its y, and the constant. A clockwise rotation by 90
// degrees moves the top left corner to the top right: (x, y) -> (1 - y, x). The result is scaled to
// -1…1 with y up.
std::array<GLfloat, 9> TurnOf(int rotation) {
  switch (rotation) {
    case 90:
      return {0, -2, 0, -2, 0, 0, 1, 1, 1};
    case 180:
      return {-2, 0, 0, 0, 2, 0, 1, -1, 1};
    case 270:
      return {0, 2, 0, 2, 0, 0, -1, -1, 1};
    default:
      return {2, 0, 0, 0, -2, 0, -1, 1, 1};
  }
}

}  // namespace

PixelArea PixelsOf(const Area& area, int width, int height) {
  if (area.none()) return {};
  const auto at = [](double share, int size) {
    return static_cast<int>(std::lround(std::clamp(share, 0.0, 1.0) * size));
  };
  const int left = at(area.left, width), right = at(area.left + area.width, width);
  const int top = at(area.top, height), bottom = at(area.top + area.height, height);
  return {left, height - bottom, right - left, bottom - top};
}

PixelArea FitPicture(const PixelArea& area, int width, int height, int rotation) {
  if (IsAcross(rotation)) std::swap(width, height);
  const double scale =
      std::min(static_cast<double>(area.width) / width, static_cast<double>(area.height) / height);
  const auto fitted = [scale](int size, int room) {
    return std::clamp(static_cast<int>(std::lround(scale * size)), 1, room);
  };
  const int w = fitted(width, area.width), h = fitted(height, area.height);
  return {area.left + (area.width - w) / 2, area.bottom + (area.height - h) / 2, w, h};
}

PictureLayer::PictureLayer()
    : program_(std::string(kTurnGlsl) + kPictureGlsl, kLumaGlsl),
      feature_program_(std::string(kTurnGlsl) + kFeatureGlsl, kDiscGlsl) {}

void PictureLayer::Set(const uint8_t* luma, int width, int height, size_t stride, int rotation) {
  if (!luma || width <= 0 || height <= 0 || width > 65535 || height > 65535)
    ThrowUsage("a camera picture of " + std::to_string(width) + " x " + std::to_string(height) +
               " pixels cannot be shown");
  if (stride < static_cast<size_t>(width))
    ThrowUsage("rows of " + std::to_string(width) + " pixels do not fit into a stride of " +
               std::to_string(stride) + " bytes");
  if (rotation % 90 != 0 || rotation < 0 || rotation > 270)
    ThrowUsage("pictures are turned by 0, 90, 180 or 270 degrees, not by " +
               std::to_string(rotation));
  const std::lock_guard lock(mutex_);
  const auto row = static_cast<size_t>(width);
  next_.pixels.resize(row * static_cast<size_t>(height));
  for (size_t y = 0; y < static_cast<size_t>(height); ++y)
    std::memcpy(&next_.pixels[y * row], luma + y * stride, row);
  next_.width = width;
  next_.height = height;
  next_.rotation = rotation;
  fresh_ = true;
}

void PictureLayer::Update(const StreamScene& scene) {
  size_t used = 0;
  const int width = std::max(scene.camera.width, 1), height = std::max(scene.camera.height, 1);
  for (const SceneFeature& feature : scene.features) {
    features_.Set(used++, {static_cast<float>((feature.x + 0.5) / width),
                           static_cast<float>((feature.y + 0.5) / height),
                           static_cast<uint32_t>(feature.use)});
  }
  features_.Shrink(used);
}

// Uploads the image; one that exceeds the maximum texture size is subsampled.
size_t PictureLayer::Upload() {
  {
    const std::lock_guard lock(mutex_);
    if (fresh_) {
      std::swap(next_, shown_);
      fresh_ = uploaded_ = false;
    }
  }
  if (!any()) return 0;
  if (texture_ == 0) {
    glGenTextures(1, &texture_);
    texture_width_ = texture_height_ = 0;
    uploaded_ = false;
  }
  glBindTexture(GL_TEXTURE_2D, texture_);
  if (uploaded_) return 0;
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  most = std::max(most, 1);
  const int every = (std::max(shown_.width, shown_.height) + most - 1) / most;
  const int width = (shown_.width + every - 1) / every;
  const int height = (shown_.height + every - 1) / every;
  std::vector<uint8_t> fewer;
  const uint8_t* pixels = shown_.pixels.data();
  if (every > 1) {
    fewer.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
    for (int y = 0; y < shown_.height; y += every) {
      for (int x = 0; x < shown_.width; x += every)
        fewer.push_back(pixels[static_cast<size_t>(y) * static_cast<size_t>(shown_.width) +
                               static_cast<size_t>(x)]);
    }
    pixels = fewer.data();
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (width != texture_width_ || height != texture_height_) {
    for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, width, height, 0, GL_RED, GL_UNSIGNED_BYTE, pixels);
    texture_width_ = width;
    texture_height_ = height;
  } else {
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, GL_RED, GL_UNSIGNED_BYTE, pixels);
  }
  uploaded_ = true;
  return static_cast<size_t>(width) * static_cast<size_t>(height);
}

size_t PictureLayer::Draw(const ViewSettings& view, const PixelArea& area) {
  size_t uploaded = Upload();
  if (!any() || area.none()) return uploaded;
  const PixelArea fitted = FitPicture(area, shown_.width, shown_.height, shown_.rotation);
  glViewport(fitted.left, fitted.bottom, fitted.width, fitted.height);
  glScissor(fitted.left, fitted.bottom, fitted.width, fitted.height);
  const std::array<GLfloat, 9> turn = TurnOf(shown_.rotation);
  program_.Use();
  glUniformMatrix3fv(program_.At("turn"), 1, GL_FALSE, turn.data());
  glUniform1i(program_.At("luma"), 0);
  if (layout_ == 0) glGenVertexArrays(1, &layout_);
  glBindVertexArray(layout_);  // without attributes: gl_VertexID selects the corner
  glDisable(GL_BLEND);
  glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  if (!view.features || features_.size() == 0) return uploaded;

  uploaded += features_.Upload();
  feature_program_.Use();
  glUniformMatrix3fv(feature_program_.At("turn"), 1, GL_FALSE, turn.data());
  DrawFeatures(view);
  return uploaded;
}

void PictureLayer::DrawFeatures(const ViewSettings& view) {
  if (feature_layout_ == 0) {
    glGenVertexArrays(1, &feature_layout_);
    glBindVertexArray(feature_layout_);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(Vertex),
                           reinterpret_cast<const void*>(offsetof(Vertex, use)));
  }
  glBindVertexArray(feature_layout_);
  const Colors& c = view.colors;
  std::array<GLfloat, 12> inks{};
  auto at = inks.begin();
  for (const Color& ink : {c.unmatched, c.matched, c.fresh, c.moving})
    at = std::copy(ink.begin(), ink.end(), at);
  glUniform3fv(feature_program_.At("inks"), 4, inks.data());
  glUniform1i(feature_program_.At("unmatched"), view.unmatched_features);
  glUniform1f(feature_program_.At("size"), static_cast<GLfloat>(view.feature_size));
  glEnable(GL_BLEND);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(features_.size()));
}

void PictureLayer::Forget() {
  program_.Forget();
  feature_program_.Forget();
  features_.Forget();
  texture_ = layout_ = feature_layout_ = 0;
  uploaded_ = false;
}

void PictureLayer::Release() {
  program_.Release();
  feature_program_.Release();
  features_.Release();
  glDeleteTextures(1, &texture_);
  for (GLuint* layout : {&layout_, &feature_layout_}) glDeleteVertexArrays(1, layout);
  Forget();
}

}  // namespace alidade::gles
