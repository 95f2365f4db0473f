#include "qr_code.h"

#ifdef ALIDADE_QRENCODE
#include <qrencode.h>

#include <memory>
#endif

namespace alidade {

std::string QrCode(const std::string& text) {
#ifdef ALIDADE_QRENCODE
  constexpr int kMargin = 4;  // margin of light modules
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_L, QR_MODE_8, 1), QRcode_free);
  if (!code) return {};
  const auto dark = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < code->width && y < code->width &&
           (code->data[y * code->width + x] & 1) != 0;
  };
  // Two rows of modules per line. Draws the light modules in white on black, whatever the colors of
  // the terminal.
  std::string lines;
  for (int y = -kMargin; y < code->width + kMargin; y += 2) {
    lines += "\x1b[97;40m";
    for (int x = -kMargin; x < code->width + kMargin; ++x) {
      const bool upper = !dark(x, y), lower = !dark(x, y + 1);
      lines += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
    }
    lines += "\x1b[0m\n";
  }
  return lines;
#else
  static_cast<void>(text);
  return {};
#endif
}

}  // namespace alidade
