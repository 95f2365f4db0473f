// Parallel loops whose results do not depend on how many threads there are.
#pragma once

#include <functional>

namespace alidade {

// Threads used by ParallelFor in all of the program, the caller's included. 0 = one per core. Call
// it before the first loop; later calls take effect at the next loop.
void SetThreadCount(int threads);
int ThreadCount();

// Calls body(i) for each i in [0, count), spread over the threads; returns when all are done. The
// body of one i must not touch what another's writes: then the result is the same with any number
// of threads (reduce afterwards, in order). A loop inside a loop's body, or while another thread's
// loop holds the workers, runs on the caller alone. The first exception thrown by a body is thrown
// again here.
void ParallelFor(int count, const std::function<void(int)>& body);

// From now on the calling thread's loops run on it alone, leaving the workers to the others: for a
// thread beside the work, whose CPU time is to be told apart.
void KeepLoopsOnThisThread();

// The calling thread gives way to the others of the program where the system can do that (Linux).
void LowerThreadPriority();

}  // namespace alidade
