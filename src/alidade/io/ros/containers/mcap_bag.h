// The MCAP container: records of an opcode, a length and content. Messages are stored directly in
// the file or in chunks (lz4, zstd or uncompressed). Chunks and their messages are indexed; the
// summary at the end of the file locates the indexes. Implemented from the specification, because
// Debian has no library for it.
#pragma once

#include <memory>

#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/containers/byte_source.h"

namespace alidade {

bool LooksLikeMcap(std::string_view start);

// A file without a footer or indexes, or with damaged ones, is read from its start as far as
// possible. Throws Error (input) when it is not an MCAP file.
std::unique_ptr<BagFile> OpenMcapFile(std::unique_ptr<ByteSource> source);

}  // namespace alidade
