#include <gtest/gtest.h>

#include "alidade/run/batch/batch_process.h"
#include "alidade/run/play/loop.h"
#include "support/temp_folder.h"

namespace alidade::batch_process_test {
namespace {

// The SIGINT comes right after the fork, before the child is another program or catches anything.
TEST(BatchProcess, OneJustBegunIsInterruptedToo) {
  const TempFolder folder;
  CatchInterrupts();
  for (int i = 0; i < 20; ++i) {
    ProcessEnd how;
    ProcessEvents events;
    events.begun = [](size_t) { RequestInterrupt(); };
    events.ended = [&](size_t, const ProcessEnd& end) { how = end; };
    RunProcesses({{{"/bin/sleep", "20"}, folder / "log.txt"}}, 1, events);
    ForgetInterrupts();
    ASSERT_EQ(how.status, kInterruptedStatus);
  }
}

}  // namespace
}  // namespace alidade::batch_process_test
