#include "alidade/gles/eye.h"

#include <cmath>

namespace alidade::gles {

// The eye's z axis points forward and y down; OpenGL's clip space has y up. Depth is 1 - 2 nearest
// / z, with the far plane at infinity.
const char* const kEyeGlsl = R"(
uniform mat4 eye;
uniform vec2 focal;
uniform vec2 area;
uniform float nearest;
vec3 Eye(vec3 p) { return (eye * vec4(p, 1.0)).xyz; }
vec4 Clip(vec3 p) { return vec4(focal.x * p.x, -focal.y * p.y, p.z - 2.0 * nearest, p.z); }
const vec4 kHidden = vec4(2.0, 2.0, 2.0, 1.0);
)";

void SetEye(const GlProgram& program, const ViewSettings& view, int width, int height) {
  const Se3 T_eye_world = view.T_world_eye.Inverse();
  GLfloat columns[16] = {};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) columns[4 * c + r] = static_cast<GLfloat>(T_eye_world.R(r, c));
    columns[12 + r] = static_cast<GLfloat>(T_eye_world.t(r));
  }
  columns[15] = 1;
  const double focal = 1 / std::tan(view.fov / 2);  // in half heights of the viewport
  glUniformMatrix4fv(program.At("eye"), 1, GL_FALSE, columns);
  glUniform2f(program.At("focal"), static_cast<GLfloat>(focal * height / width),
              static_cast<GLfloat>(focal));
  glUniform2f(program.At("area"), static_cast<GLfloat>(width), static_cast<GLfloat>(height));
  glUniform1f(program.At("nearest"), static_cast<GLfloat>(view.nearest));
  glUniform1f(program.At("other_maps"), static_cast<GLfloat>(view.other_maps));
  glUniform1i(program.At("anchors"), 0);
}

void SetColor(const GlProgram& program, const char* uniform, const Color& color) {
  glUniform3f(program.At(uniform), color[0], color[1], color[2]);
}

}  // namespace alidade::gles
