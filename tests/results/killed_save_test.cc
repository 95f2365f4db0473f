// kill -9 while a map is saved.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "alidade/base/random.h"
#include "alidade/io/files/file.h"
#include "support/saved_map.h"
#include "support/temp_folder.h"

namespace alidade::killed_save_test {
namespace {

namespace fs = std::filesystem;

int FilesIn(const std::string& folder) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) count += entry.exists() ? 1 : 0;
  return count;
}

// Saves one map and the other in turn, until it is killed.
[[noreturn]] void SaveForever(const SavedMap (&maps)[2], const std::string& path) {
  try {
    for (int i = 0;; ++i) AtomicWriteFile(path, EncodeMap(maps[i % 2]));
  } catch (...) {
    _exit(1);  // the parent sees that it was not killed
  }
}

TEST(KilledSave, LeavesTheOldMapOrTheNewOne) {
  const SavedMap maps[2] = {MakeSavedMap({.points = 4000, .cameras = 12, .clutter = 500}),
                            MakeSavedMap({.points = 3000, .cameras = 16, .clutter = 500})};
  const std::string bytes[2] = {EncodeMap(maps[0]), EncodeMap(maps[1])};
  const TempFolder folder;
  const std::string path = folder / "map.alidade";
  AtomicWriteFile(path, bytes[0]);
  Random random(50);
  int killed_in_a_write = 0;
  int found[2] = {0, 0};
  for (int kill_number = 0; kill_number < 50; ++kill_number) {
    const pid_t child = fork();
    if (child == 0) SaveForever(maps, path);
    std::this_thread::sleep_for(std::chrono::microseconds(1000 + random.Below(60000)));
    ASSERT_EQ(kill(child, SIGKILL), 0);
    int state = 0;
    ASSERT_EQ(waitpid(child, &state, 0), child);
    ASSERT_TRUE(WIFSIGNALED(state)) << "the child ended by itself";
    const std::string left = ReadFile(path);
    const int which = left == bytes[1] ? 1 : 0;
    ASSERT_TRUE(left == bytes[which]) << "neither the one map nor the other";
    ++found[which];
    EXPECT_EQ(DecodeMap(left).map.landmark_count(), maps[which].map.landmark_count());
    const int files = FilesIn(folder.path());
    EXPECT_LE(files, 2);  // what one left is gone with the next's first save, or that one's own
    killed_in_a_write += files == 2;
  }
  std::printf(
      "of 50 kills %d came within a write; then the file was the one map %d times and the other "
      "%d\n",
      killed_in_a_write, found[0], found[1]);
  AtomicWriteFile(path, bytes[1]);
  EXPECT_EQ(FilesIn(folder.path()), 1);
}

}  // namespace
}  // namespace alidade::killed_save_test
