// A file for what a long run need not hold in memory. It has no name, so nothing of it remains
// however the program ends.
#pragma once

#include <memory>
#include <string>

#include "alidade/base/byte_store.h"

namespace alidade {

// In `folder`. nullptr if no file can be created there: what would go to it stays in memory. Places
// of freed pieces are used again for pieces of the same size.
std::shared_ptr<ByteStore> MakeSpillFile(const std::string& folder);

}  // namespace alidade
