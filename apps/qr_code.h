// Prints an address as a QR code for terminals (ISO/IEC 18004, by libqrencode).
#pragma once

#include <string>

namespace alidade {

// Lines of half blocks, dark on light with a margin of four modules; empty if the program was built
// without libqrencode, or if the text is too long.
std::string QrCode(const std::string& text);

}  // namespace alidade
