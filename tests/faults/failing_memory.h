// Memory that runs out when a test says so: every operator new of the program this is linked into,
// and every image of OpenCV's.
#pragma once

namespace alidade {

// From now on so many allocations succeed, counted over all threads; the next `failures` fail.
void FailAllocations(long after, long failures = 1);
// No more of them fail. Returns how many did.
long StopFailing();
long AllocationCount();  // of all threads, so far

}  // namespace alidade
