// Databases compressed as a whole (.db3.zstd) that unpack to more than they may.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>

#include "alidade/io/files/open_source.h"
#include "bags/small_recording.h"
#include "support/expect_error.h"
#include "support/small_disk.h"

namespace alidade::packed_file_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class PackedFile : public testing::Test {
 protected:
  PackedFile() {
    std::filesystem::create_directory(temporary_);
    setenv("TMPDIR", temporary_.c_str(), 1);
  }
  ~PackedFile() override { unsetenv("TMPDIR"); }
  std::string ComplaintOf(const std::string& plain) {
    const std::string path = folder_.Write("walk.db3.zstd", Packed("zstd", plain));
    return MessageOf(ErrorKind::kInput, [&] { OpenSource(path); });
  }
  TempFolder folder_;
  const std::string temporary_ = folder_ / "tmp";
};

TEST_F(PackedFile, ABombIsRefusedBeforeItIsUnpacked) {
  const std::string zeros(size_t{80} << 20, '\0');
  EXPECT_THAT(ComplaintOf("SQLite format 3" + zeros),
              AllOf(HasSubstr("walk.db3.zstd"), HasSubstr("unpacks to more than 64 MB"),
                    HasSubstr("zstd -d")));
  EXPECT_TRUE(std::filesystem::is_empty(temporary_));
}

TEST_F(PackedFile, SomeOfTheDiskIsLeftFree) {
  const SmallDisk disk(temporary_, 32 << 10);
  if (!disk.mounted()) GTEST_SKIP() << "mounting needs privileges";
  const std::string zeros(size_t{60} << 20, '\0');
  EXPECT_THAT(ComplaintOf("SQLite format 3" + zeros),
              AllOf(HasSubstr("walk.db3.zstd"), HasSubstr("free"), HasSubstr("TMPDIR"),
                    Not(HasSubstr("No space left"))));
}

}  // namespace
}  // namespace alidade::packed_file_test
