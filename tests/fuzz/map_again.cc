#include "alidade/base/error.h"
#include "fuzz/targets.h"
#include "support/map_bytes.h"
#include "support/use_map.h"

namespace alidade::fuzz {

// A map that was read once is valid, so nothing may be rejected any more.
void MapAgain(std::string_view bytes) {
  std::string sealed(bytes);
  RepairChecksum(sealed);
  const SavedMap saved = DecodeMap(sealed);
  std::string complaint;
  try {
    complaint = UseMap(saved);
  } catch (const Error& error) {
    complaint = error.what();
  }
  Expect(complaint.empty(), "a map that was read is of no use: " + complaint);
}

}  // namespace alidade::fuzz
