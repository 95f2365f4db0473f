// MCAP: records of an opcode, a length and that many bytes; messages stand in the file or in chunks
// (lz4, zstd, or not packed), chunks and their messages have indexes, which the summary at the end
// of the file tells of. Read by its specification: Debian has no library for it.
#pragma once

#include <memory>

#include "alidade/io/ros/containers/bags_module.h"
#include "alidade/io/ros/containers/byte_source.h"

namespace alidade {

bool LooksLikeMcap(std::string_view start);

// A file without a footer or without indexes, or with damaged ones, is read from its start, as far
// as it goes. Throws Error (input) when it is no MCAP file.
std::unique_ptr<BagFile> OpenMcapFile(std::unique_ptr<ByteSource> source);

}  // namespace alidade
