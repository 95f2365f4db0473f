#include "alidade/view/svg.h"

#include <cmath>

#include "alidade/base/print.h"

namespace alidade {

std::string SvgNumber(double value, int digits) {
  char text[40];
  PrintTo(text, sizeof(text), "%.*f", digits, value);
  return text;
}

std::string OpenSvg(double width, double height, const std::string& label) {
  return "<svg viewBox=\"0 0 " + SvgNumber(width, 0) + " " + SvgNumber(height, 0) +
         "\" role=\"img\" aria-label=\"" + EscapeHtml(label) + "\">\n";
}

std::string SvgText(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + SvgNumber(x) + "\" y=\"" + SvgNumber(y) + "\" text-anchor=\"" + anchor +
         "\">" + EscapeHtml(text) + "</text>\n";
}

double RoundStep(double wanted) {
  if (!(wanted > 0) || !std::isfinite(wanted)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  return power * (wanted / power >= 5 ? 5 : wanted / power >= 2 ? 2 : 1);
}

std::string SvgScaleBar(double scale, double height, const std::string& unit) {
  const double length = RoundStep(kPictureWidth / 8 / scale);
  const double left = 16, right = left + length * scale, y = height - 14;
  char label[64];
  PrintTo(label, sizeof(label), "%g %s", length, unit.c_str());
  return "<path class=\"scale\" d=\"M" + SvgNumber(left) + " " + SvgNumber(y) + "H" +
         SvgNumber(right) + "\"/>\n" + SvgText(left, y - 6, "start", label);
}

std::string EscapeHtml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace alidade
