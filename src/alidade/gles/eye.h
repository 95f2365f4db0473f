// Uniforms of the virtual camera, shared by all layers of the map.
#pragma once

#include "alidade/gles/gl_program.h"
#include "alidade/gles/view.h"

namespace alidade::gles {

// GLSL functions: Eye(p) transforms a world point to the eye's frame, Clip(p) projects such a
// point. Uniforms: `area`, the viewport's size in pixels, and `nearest`.
extern const char* const kEyeGlsl;

// Sets the uniforms of the current program; `width`, `height`: the viewport in pixels.
void SetEye(const GlProgram& program, const ViewSettings& view, int width, int height);

// Sets a color uniform of the current program.
void SetColor(const GlProgram& program, const char* uniform, const Color& color);

}  // namespace alidade::gles
