// Memory of the process.
#pragma once

namespace alidade {

// Returns freed memory to the system, where the C library can: without it, the process keeps most
// of what it has used at its peak. Takes a few milliseconds. Thread-safe.
void ReturnFreedMemory();

}  // namespace alidade
