// A shader program: two texts until a context compiles them.
#pragma once

#include <GLES3/gl3.h>

#include <string>

namespace alidade::gles {

class GlProgram {
 public:
  // What follows "#version 300 es" and the precision.
  GlProgram(std::string vertex, std::string fragment)
      : vertex_(std::move(vertex)), fragment_(std::move(fragment)) {}

  // Current from now on; compiled when it is not yet. Throws Error (input) with what the driver
  // says.
  void Use();
  // Of a uniform of the current program. Unused ones are -1, which OpenGL passes over.
  GLint At(const char* uniform) const { return glGetUniformLocation(name_, uniform); }

  void Forget() { name_ = 0; }  // the context is gone
  void Release();

 private:
  std::string vertex_, fragment_;
  GLuint name_ = 0;
};

}  // namespace alidade::gles
