// What all layers of the map need to know of the eye, and how they are told.
#pragma once

#include "alidade/gles/gl_program.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

// GLSL: Eye(p) is a point of the world before the eye, Clip(p) such a one on the screen; `area` is
// the size of the viewport, pixels; `nearest`.
extern const char* const kEyeGlsl;

// Tells the current program, for a viewport of that many pixels.
void SetEye(const GlProgram& program, const ViewSettings& view, int width, int height);

// Of the current program.
void SetColor(const GlProgram& program, const char* uniform, const Color& color);

}  // namespace alidade::gles
