// Parallel loops whose results do not depend on the number of threads.
#pragma once

#include <functional>

namespace alidade {

// Number of threads ParallelFor uses in the whole process, the calling thread included; 0 = one per
// core. Takes effect at the next loop.
void SetThreadCount(int threads);
int ThreadCount();

// Calls body(i) for each i in [0, count) on several threads and returns when all calls are done.
// One body must not access what another writes; then the result is the same for any number of
// threads (reduce afterwards, in index order). A nested loop, or one started while another thread's
// loop uses the workers, runs on the calling thread only. Rethrows the first exception thrown by a
// body.
void ParallelFor(int count, const std::function<void(int)>& body);

// From now on, loops started by the calling thread run on that thread only. For threads whose CPU
// time is measured separately.
void KeepLoopsOnThisThread();

// Lowers the scheduling priority of the calling thread (nice 5). Does nothing except on Linux.
void LowerThreadPriority();

}  // namespace alidade
