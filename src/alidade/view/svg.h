// Helpers for SVG drawings. The page (page.h) defines the colors of CSS classes.
#pragma once

#include <string>

namespace alidade {

inline constexpr double kPictureWidth = 900;  // of all drawings, in viewBox units

std::string SvgNumber(double value, int digits = 1);
std::string OpenSvg(double width, double height, const std::string& label);
std::string SvgText(double x, double y, const std::string& anchor, const std::string& text);

// The largest number of the form 1, 2 or 5 times a power of ten that does not exceed `wanted`.
double RoundStep(double wanted);

// At the bottom left of a drawing of kPictureWidth, about an eighth of it long. `scale`: of the
// drawing's units per `unit`.
std::string SvgScaleBar(double scale, double height, const std::string& unit);

std::string EscapeHtml(const std::string& text);

}  // namespace alidade
