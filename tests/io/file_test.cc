#include "alidade/io/files/file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::file_test {
namespace {

int FilesIn(const std::string& folder) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    count += entry.exists() ? 1 : 0;
  return count;
}

TEST(File, ComesBackAsWritten) {
  const TempFolder folder;
  std::string bytes(100000, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7);
  AtomicWriteFile(folder / "a", bytes);
  EXPECT_EQ(ReadFile(folder / "a"), bytes);
  AtomicWriteFile(folder / "a", "short", Sync::kNo);
  EXPECT_EQ(ReadFile(folder / "a"), "short");
  EXPECT_EQ(FilesIn(folder.path()), 1);
}

TEST(File, ThatIsMissingIsNamed) {
  const std::string message = MessageOf(ErrorKind::kInput, [] { ReadFile("/no/such/file"); });
  EXPECT_THAT(message, testing::HasSubstr("/no/such/file"));
  EXPECT_THAT(message, testing::HasSubstr("No such file"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { AtomicWriteFile("/no/such/file", "x"); }),
              testing::HasSubstr("/no/such/file"));
  MessageOf(ErrorKind::kInput, [] { ReadFile("/tmp"); });
}

TEST(File, FailedWriteLeavesTheOldFileAndNoTemporary) {
  const TempFolder folder;
  AtomicWriteFile(folder / "a", "old");
  // Renaming onto a non-empty folder fails after all bytes were written.
  folder.Write("b/inside", "x");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { AtomicWriteFile(folder / "b", "new"); }),
              testing::HasSubstr("cannot write"));
  if (geteuid() != 0) {
    ASSERT_EQ(chmod(folder.path().c_str(), 0500), 0);
    MessageOf(ErrorKind::kInput, [&] { AtomicWriteFile(folder / "a", "new"); });
    ASSERT_EQ(chmod(folder.path().c_str(), 0700), 0);
  }
  EXPECT_EQ(ReadFile(folder / "a"), "old");
  EXPECT_EQ(FilesIn(folder.path()), 2);
}

// A limit on file sizes makes a write fail in the middle, as a full disk does.
TEST(File, DiskThatFillsUpLeavesTheOldFileAndNoTemporary) {
  const TempFolder folder;
  AtomicWriteFile(folder / "a", "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{4096, before.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = MessageOf(
      ErrorKind::kInput, [&] { AtomicWriteFile(folder / "a", std::string(100000, 'x')); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(message, testing::HasSubstr("File too large"));
  EXPECT_EQ(ReadFile(folder / "a"), "old");
  EXPECT_EQ(FilesIn(folder.path()), 1);
}

TEST(File, TemporariesOfKilledProgramsAreRemovedByTheNextWrite) {
  const TempFolder folder;
  const std::string left = folder.Write("a.tmp123-0", "half");
  const std::string in_use = folder.Write("a.tmp123-1", "another program is at it");
  const std::string foreign = folder.Write("a.tmp123", "not one of ours");
  const int fd = open(in_use.c_str(), O_RDONLY);
  ASSERT_TRUE(Occupy(fd));
  // Does not remove stale temporaries.
  AtomicWriteFile(folder / "a", "many small files", Sync::kNo);
  EXPECT_TRUE(std::filesystem::exists(left));
  AtomicWriteFile(folder / "a", "new");
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_TRUE(std::filesystem::exists(in_use));
  EXPECT_TRUE(std::filesystem::exists(foreign));
  close(fd);
  AtomicWriteFile(folder / "a", "newer");
  EXPECT_FALSE(std::filesystem::exists(in_use));
  EXPECT_EQ(FilesIn(folder.path()), 2);
}

// In a container a new process may have the id of a killed one.
TEST(File, ATemporaryOfTheSameNameIsNoObstacle) {
  const TempFolder folder;
  for (int number = 0; number < 50; ++number) {
    folder.Write("a.tmp" + std::to_string(getpid()) + "-" + std::to_string(number), "half");
  }
  AtomicWriteFile(folder / "a", "new", Sync::kNo);
  EXPECT_EQ(ReadFile(folder / "a"), "new");
}

}  // namespace
}  // namespace alidade::file_test
