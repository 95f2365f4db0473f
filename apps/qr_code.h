// An address as a QR code on a terminal (ISO/IEC 18004, by libqrencode).
#pragma once

#include <string>

namespace alidade {

// Lines of half blocks, dark on light with four modules of margin; empty when the program was built
// without libqrencode, or the text is too long.
std::string QrCode(const std::string& text);

}  // namespace alidade
