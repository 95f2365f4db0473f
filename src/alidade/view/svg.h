// The small change of SVG drawings. Classes get their colours from the page (page.h).
#pragma once

#include <string>

namespace alidade {

inline constexpr double kPictureWidth = 900;  // of all drawings, in the units of their viewBox

std::string SvgNumber(double value, int digits = 1);
std::string OpenSvg(double width, double height, const std::string& label);
std::string SvgText(double x, double y, const std::string& anchor, const std::string& text);

// The largest of 1, 2 and 5 times a power of ten that is not above `wanted`.
double RoundStep(double wanted);

std::string EscapeHtml(const std::string& text);

}  // namespace alidade
