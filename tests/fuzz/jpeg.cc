#include "alidade/base/error.h"
#include "fuzz/targets.h"
#include "fuzz/use_decoded.h"

namespace alidade::fuzz {

void Jpeg(std::string_view bytes) {
  if (!LooksLikeJpeg(bytes)) ThrowInput("is no JPEG");
  UseDecoded(bytes, DecodeJpeg, JpegSize(bytes));
}

}  // namespace alidade::fuzz
