#include "alidade/gles/line_layers.h"

#include <cstddef>
#include <string>

#include "alidade/gles/eye.h"

namespace alidade::gles {
namespace {

// A line as a strip of four vertices; gl_VertexID selects the end and the side. The part behind the
// eye is clipped at `nearest`, because its projection would be mirrored. An extra half pixel per
// side gives a soft edge.
constexpr const char* kWidenGlsl = R"(
uniform float line_width;
out float across;
out float strong;
void Widen(vec3 a, vec3 b, int corner, float strength) {
  strong = strength;
  across = 0.0;
  gl_Position = kHidden;
  if (strength <= 0.0 || (a.z <= nearest && b.z <= nearest)) return;
  if (a.z < nearest) a = mix(b, a, (b.z - nearest) / (b.z - a.z));
  if (b.z < nearest) b = mix(a, b, (a.z - nearest) / (a.z - b.z));
  vec4 ca = Clip(a), cb = Clip(b);
  vec2 along = (cb.xy / cb.w - ca.xy / ca.w) * area;
  along = length(along) > 1e-6 ? normalize(along) : vec2(1.0, 0.0);
  float side = float(corner & 1) * 2.0 - 1.0;
  gl_Position = corner < 2 ? ca : cb;
  gl_Position.xy += side * vec2(-along.y, along.x) * (line_width + 1.0) / area * gl_Position.w;
  across = side * (line_width + 1.0) * 0.5;
}
)";

constexpr const char* kPathGlsl = R"(
layout(location = 0) in vec3 from;
layout(location = 1) in uint from_slot;
layout(location = 2) in vec3 to;
layout(location = 3) in uint to_slot;
void main() {
  float from_strength, to_strength;
  vec3 a = Eye(Place(from_slot, from, from_strength));
  vec3 b = Eye(Place(to_slot, to, to_strength));
  Widen(a, b, gl_VertexID, min(from_strength, to_strength));
}
)";

// Eight lines with six vertices each: from the camera to the image corners, and around the image.
// The keyframe's scale does not affect the frustum's size.
constexpr const char* kFrustumGlsl = R"(
layout(location = 0) in uint slot;
uniform vec2 corners[4];
uniform float deep;
const int kCorner[6] = int[6](0, 1, 2, 2, 1, 3);
void main() {
  int line = gl_VertexID / 6;
  float size = deep * Range(slot).w;
  vec3 from = line < 4 ? vec3(0.0) : size * vec3(corners[line - 4], 1.0);
  vec3 to = size * vec3(corners[line < 4 ? line : (line - 3) & 3], 1.0);
  float strength;
  vec3 a = Eye(Place(slot, from, strength));
  vec3 b = Eye(Place(slot, to, strength));
  Widen(a, b, kCorner[gl_VertexID % 6], strength);
}
)";

constexpr const char* kLineGlsl = R"(
in float across;
in float strong;
uniform float line_width;
uniform vec3 ink;
out vec4 result;
void main() {
  result = vec4(ink, strong * clamp(0.5 * line_width + 0.5 - abs(across), 0.0, 1.0));
}
)";

std::string LineProgram(const char* main) {
  return std::string(kAnchorsGlsl) + kEyeGlsl + kWidenGlsl + main;
}

void SetLines(const GlProgram& program, const ViewSettings& view, int width, int height) {
  SetEye(program, view, width, height);
  glUniform1f(program.At("line_width"), static_cast<GLfloat>(view.line_width));
}

void PointTo(GLuint location, GLint floats, size_t stride, size_t offset) {
  const auto* at = reinterpret_cast<const void*>(offset);
  glEnableVertexAttribArray(location);
  if (floats > 0) {
    glVertexAttribPointer(location, floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride), at);
  } else {
    glVertexAttribIPointer(location, 1, GL_UNSIGNED_INT, static_cast<GLsizei>(stride), at);
  }
  glVertexAttribDivisor(location, 1);
}

}  // namespace

PathLayer::PathLayer() : program_(LineProgram(kPathGlsl), kLineGlsl) {}

void PathLayer::Update(const StreamScene& scene, const Anchors& anchors, bool anew) {
  if (anew || scene.path.size() < done_) done_ = used_ = 0, joined_ = false;
  for (; done_ < scene.path.size(); ++done_) {
    const SceneFrame& frame = scene.path[done_];
    const auto keyframe = scene.keyframes.find(frame.reference);
    if (keyframe == scene.keyframes.end()) {
      joined_ = false;
      continue;
    }
    const Eigen::Vector3f t = frame.T_reference_camera.t.cast<float>();
    const End here{t.x(), t.y(), t.z(), anchors.SlotOf(frame.reference)};
    if (joined_ && last_map_ == keyframe->second.map) segments_.Set(used_++, {last_, here});
    last_ = here;
    last_map_ = keyframe->second.map;
    joined_ = true;
  }
  segments_.Shrink(used_);
}

size_t PathLayer::Draw(const ViewSettings& view, int width, int height) {
  if (segments_.size() == 0) return 0;
  const size_t uploaded = segments_.Upload();
  if (layout_ == 0) {
    glGenVertexArrays(1, &layout_);
    glBindVertexArray(layout_);
    constexpr size_t kStride = sizeof(Segment), kTo = offsetof(Segment, to);
    PointTo(0, 3, kStride, 0);
    PointTo(1, 0, kStride, offsetof(End, slot));
    PointTo(2, 3, kStride, kTo);
    PointTo(3, 0, kStride, kTo + offsetof(End, slot));
  }
  glBindVertexArray(layout_);
  program_.Use();
  SetLines(program_, view, width, height);
  SetColor(program_, "ink", view.colors.path);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(segments_.size()));
  return uploaded;
}

void PathLayer::Forget() {
  program_.Forget();
  segments_.Forget();
  layout_ = 0;
}

void PathLayer::Release() {
  program_.Release();
  segments_.Release();
  glDeleteVertexArrays(1, &layout_);
  layout_ = 0;
}

FrustumLayer::FrustumLayer() : program_(LineProgram(kFrustumGlsl), kLineGlsl) {
  camera_slot_.Add(kCameraSlot);
}

void FrustumLayer::Update(const StreamScene& scene, const Anchors& anchors) {
  const Camera& c = scene.camera;
  const double right = c.width - 0.5, bottom = c.height - 0.5;
  const double places[4][2] = {{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}};
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d corner = c.Unproject({places[k][0], places[k][1]});
    corners_[k][0] = static_cast<float>(corner.x());
    corners_[k][1] = static_cast<float>(corner.y());
  }
  size_t used = 0;
  for (const auto& [id, keyframe] : scene.keyframes) slots_.Set(used++, anchors.SlotOf(id));
  slots_.Shrink(used);
}

void FrustumLayer::DrawSome(const Color& color, double deep, GLsizei count) {
  SetColor(program_, "ink", color);
  glUniform1f(program_.At("deep"), static_cast<GLfloat>(deep));
  glDrawArraysInstanced(GL_TRIANGLES, 0, 48, count);
}

size_t FrustumLayer::Draw(const ViewSettings& view, double deep, bool lost, int width, int height) {
  program_.Use();
  SetLines(program_, view, width, height);
  glUniform2fv(program_.At("corners"), 4, corners_[0]);
  size_t uploaded = 0;
  const auto lay_out = [](GLuint& layout) {
    if (layout == 0) {
      glGenVertexArrays(1, &layout);
      glBindVertexArray(layout);
      PointTo(0, 0, sizeof(uint32_t), 0);
    }
    glBindVertexArray(layout);
  };
  if (view.keyframes && slots_.size() > 0) {
    uploaded += slots_.Upload();
    lay_out(layout_);
    DrawSome(view.colors.keyframes, deep, static_cast<GLsizei>(slots_.size()));
  }
  if (view.camera) {
    uploaded += camera_slot_.Upload();
    lay_out(camera_layout_);
    DrawSome(lost ? view.colors.lost : view.colors.tracked, 2 * deep, 1);
  }
  return uploaded;
}

void FrustumLayer::Forget() {
  program_.Forget();
  slots_.Forget();
  camera_slot_.Forget();
  layout_ = camera_layout_ = 0;
}

void FrustumLayer::Release() {
  program_.Release();
  slots_.Release();
  camera_slot_.Release();
  for (GLuint* layout : {&layout_, &camera_layout_}) glDeleteVertexArrays(1, layout);
  layout_ = camera_layout_ = 0;
}

}  // namespace alidade::gles
