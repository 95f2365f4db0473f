// A shader program, compiled on first use in a context.
#pragma once

#include <GLES3/gl3.h>

#include <string>
#include <utility>

namespace alidade::gles {

class GlProgram {
 public:
  // The shaders without "#version 300 es" and the precision statement.
  GlProgram(std::string vertex, std::string fragment)
      : vertex_(std::move(vertex)), fragment_(std::move(fragment)) {}

  // Makes the program current; compiles it if necessary. Throws Error (input) with the driver's
  // message.
  void Use();
  // Location of a uniform of the current program; -1 if unused, which OpenGL ignores.
  GLint At(const char* uniform) const { return glGetUniformLocation(name_, uniform); }

  void Forget() { name_ = 0; }  // call when the context was lost
  void Release();

 private:
  std::string vertex_, fragment_;
  GLuint name_ = 0;
};

}  // namespace alidade::gles
