#include "alidade/gles/gl_program.h"

#include <algorithm>

#include "alidade/base/error.h"

namespace alidade::gles {
namespace {

constexpr const char* kHead =
    "#version 300 es\nprecision highp float;\nprecision highp int;\n"
    "precision highp sampler2D;\n";

std::string LogOf(GLuint name, bool shader) {
  GLint length = 0;
  shader ? glGetShaderiv(name, GL_INFO_LOG_LENGTH, &length)
         : glGetProgramiv(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(static_cast<size_t>(std::max(length, 1)), '\0');
  shader ? glGetShaderInfoLog(name, length, nullptr, log.data())
         : glGetProgramInfoLog(name, length, nullptr, log.data());
  return log.c_str();
}

[[noreturn]] void RefuseProgram(const std::string& log) {
  ThrowInput("this context cannot compile the renderer's shaders (it needs OpenGL ES 3.0): " + log);
}

GLuint CompileShader(GLenum kind, const std::string& text) {
  const GLuint shader = glCreateShader(kind);
  if (shader == 0) RefuseProgram("no shader can be made; is a context current?");
  const char* texts[] = {kHead, text.c_str()};
  glShaderSource(shader, 2, texts, nullptr);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  const std::string log = LogOf(shader, true);
  glDeleteShader(shader);
  RefuseProgram(log);
}

}  // namespace

void GlProgram::Use() {
  if (name_ == 0) {
    const GLuint vertex = CompileShader(GL_VERTEX_SHADER, vertex_);
    const GLuint fragment = CompileShader(GL_FRAGMENT_SHADER, fragment_);
    const GLuint program = glCreateProgram();
    glAttachShader(program, vertex);
    glAttachShader(program, fragment);
    glLinkProgram(program);
    glDeleteShader(vertex);  // takes effect when the program is deleted
    glDeleteShader(fragment);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) {
      const std::string log = LogOf(program, false);
      glDeleteProgram(program);
      RefuseProgram(log);
    }
    name_ = program;
  }
  glUseProgram(name_);
}

void GlProgram::Release() {
  glDeleteProgram(name_);  // 0 is ignored
  name_ = 0;
}

}  // namespace alidade::gles
