#include "alidade/io/files/spill_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/temp_folder.h"

namespace alidade::spill_file_test {
namespace {

std::string ReadBack(const ByteStore::Piece& piece, size_t size) {
  std::string bytes(size, '?');
  piece.Read(bytes);
  return bytes;
}

TEST(SpillFile, GivesBackWhatWasPutAndLeavesNoFile) {
  const TempFolder folder;
  std::shared_ptr<ByteStore> store = MakeSpillFile(folder.path());
  ASSERT_NE(store, nullptr);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  std::vector<std::shared_ptr<const ByteStore::Piece>> pieces;
  for (int i = 0; i < 50; ++i)
    pieces.push_back(store->Put(std::string(1000 + i % 3, 'a' + i % 26)));
  pieces[7] = nullptr;  // its place is used again
  pieces[7] = store->Put(std::string(1001, '7'));
  store = nullptr;  // the pieces stay
  for (int i = 0; i < 50; ++i) {
    const auto size = static_cast<size_t>(1000 + i % 3);
    EXPECT_EQ(ReadBack(*pieces[i], size), std::string(size, i == 7 ? '7' : 'a' + i % 26)) << i;
  }
}

TEST(SpillFile, IsNotMadeWhereNothingCanBeWritten) {
  const TempFolder folder;
  EXPECT_EQ(MakeSpillFile(folder / "no such folder"), nullptr);
}

}  // namespace
}  // namespace alidade::spill_file_test
