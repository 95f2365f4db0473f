#include "alidade/base/error.h"
#include "alidade/map/map_file.h"
#include "fuzz/targets.h"
#include "support/map_bytes.h"

namespace alidade::fuzz {

// Tries the bytes unchanged and with a matching checksum, because a wrong checksum ends reading
// early.
void Map(std::string_view bytes) {
  std::string sealed(bytes);
  if (RepairChecksum(sealed) && sealed != bytes) {
    try {
      DecodeMap(bytes);
      Expect(false, "a map whose checksum does not fit was read");
    } catch (const Error&) {
    }
  }
  sealed.shrink_to_fit();
  DecodeMap(sealed);
}

}  // namespace alidade::fuzz
