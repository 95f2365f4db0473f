#include "alidade/io/files/media.h"

namespace alidade {

DecodedImage DecodeByMediaModule(std::string_view, ImageUse) {
  return {{}, "is no JPEG or PNG image"};
}

}  // namespace alidade
