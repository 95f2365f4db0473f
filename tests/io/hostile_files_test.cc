// Paths that are not regular files, and files that must not be read completely.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include "alidade/io/files/camera_file.h"
#include "alidade/io/files/datasets/image_list.h"
#include "alidade/io/files/file.h"
#include "alidade/io/files/open_source.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/io/files/yaml_check.h"
#include "alidade/io/text.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::hostile_files_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string Refusal(const std::string& path, size_t most_bytes = kMostFileBytes) {
  return MessageOf(ErrorKind::kInput, [&] { ReadFile(path, most_bytes); });
}

TEST(HostileFiles, APipeIsRefusedWithoutWaitingForItsWriter) {
  const TempFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(Refusal(pipe), HasSubstr("a pipe"));
  ASSERT_EQ(symlink(pipe.c_str(), (folder / "link").c_str()), 0);
  EXPECT_THAT(Refusal(folder / "link"), HasSubstr("a pipe"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(pipe); }), HasSubstr("a pipe"));
}

// A shell's <(command): the pipe has a writer.
TEST(HostileFiles, APipeThatWasHandedOverIsReadToItsEnd) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(write(ends[1], "fx: 3\n", 6), 6);
  close(ends[1]);
  EXPECT_EQ(ReadFile("/dev/fd/" + std::to_string(ends[0])), "fx: 3\n");
  close(ends[0]);
}

TEST(HostileFiles, FoldersSocketsAndDevicesAreRefused) {
  const TempFolder folder;
  EXPECT_THAT(Refusal(folder.path()), HasSubstr("a folder"));
  EXPECT_THAT(Refusal("/dev/zero"), HasSubstr("a device"));  // endless
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [] { OpenSource("/dev/zero"); }), HasSubstr("a device"));
  const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, (folder / "socket").c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_THAT(Refusal(folder / "socket"), HasSubstr("a socket"));
  close(fd);
}

// Writing a file replaces the target; it must not replace /dev/null.
TEST(HostileFiles, WhatIsNoFileIsNotReplacedByOne) {
  const TempFolder folder;
  const std::string pipe = folder / "pipe", link = folder / "link";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ASSERT_EQ(symlink(pipe.c_str(), link.c_str()), 0);
  for (const std::string& path : {pipe, link, std::string("/dev/stdout")}) {
    EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { AtomicWriteFile(path, "bytes"); }),
                AllOf(HasSubstr(path), HasSubstr("not a file")));
  }
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

TEST(HostileFiles, LinksInACircleAndPathsTooLongAreInputErrors) {
  const TempFolder folder;
  ASSERT_EQ(symlink("b", (folder / "a").c_str()), 0);
  ASSERT_EQ(symlink("a", (folder / "b").c_str()), 0);
  const std::string long_path(5000, 'x');
  for (const std::string& path : {folder / "a", long_path, long_path + "/x"}) {
    Refusal(path);
    MessageOf(ErrorKind::kInput, [&] { OpenSource(path); });
    MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(path); });
  }
}

TEST(HostileFiles, LongerThanTheirKindIsRefusedUnread) {
  const TempFolder folder;
  const std::string path = folder.Write("camera.yaml", "model: pinhole\n");
  ASSERT_EQ(truncate(path.c_str(), off_t{1} << 40), 0);  // 1 TB, sparse
  EXPECT_THAT(Refusal(path), HasSubstr("longer than 512 MB"));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadCameraFile(path); }),
              HasSubstr("longer than 16 MB"));
  const std::string just = folder.Write("just", std::string(100, 'x'));
  EXPECT_EQ(ReadFile(just, 100).size(), 100u);
  Refusal(just, 99);
}

// A sparse file takes no disk space but would take all memory when read.
TEST(HostileFiles, AStartThatIsRefusedIsAllThatIsRead) {
  const TempFolder folder;
  const std::string path = folder.Write("map.alidade", "not a map");
  const StartCheck refuse = [](std::string_view start) {
    EXPECT_EQ(start.substr(0, 9), "not a map");
    EXPECT_LE(start.size(), kStartBytes);
    ThrowInput("no map");
  };
  const auto problem = [&] {
    return MessageOf(ErrorKind::kInput, [&] { ReadFile(path, size_t{1} << 50, refuse); });
  };
  EXPECT_EQ(problem(), "no map");
  ASSERT_EQ(truncate(path.c_str(), off_t{1} << 42), 0);  // 4 TB
  EXPECT_EQ(problem(), "no map");
  folder.Write("map.alidade", std::string(3 * kStartBytes, 'x'));
  int looks = 0;
  const std::string read = ReadFile(path, kMostFileBytes, [&](std::string_view) { ++looks; });
  EXPECT_EQ(read, std::string(3 * kStartBytes, 'x'));
  EXPECT_EQ(looks, 1);
}

TEST(HostileFiles, TextOfTooManyLinesOrTooLongOnesIsRefused) {
  CheckIsText(std::string(kMostLines, '\n'), "rgb.txt");
  EXPECT_THAT(MessageOf(ErrorKind::kInput,
                        [] { CheckIsText(std::string(kMostLines + 1, '\n'), "rgb.txt"); }),
              HasSubstr("rgb.txt has more than 10000000 lines"));
  const std::string line(kMostLineBytes, 'x');
  CheckIsText("\n" + line + "\n" + line, "rgb.txt");
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { CheckIsText("\n" + line + "x\n", "rgb.txt"); }),
              HasSubstr("rgb.txt:2: the line is longer"));
}

TEST(HostileFiles, WhatIsNoImageInAFolderOfImagesIsListedAndToldWhenRead) {
  const TempFolder folder;
  folder.Write("2.png", "");
  folder.Folder("3.png");  // folders are skipped
  ASSERT_EQ(mkfifo((folder / "1.png").c_str(), 0600), 0);
  ASSERT_EQ(symlink("nowhere", (folder / "4.png").c_str()), 0);
  ASSERT_EQ(symlink("5.png", (folder / "5.png").c_str()), 0);
  EXPECT_THAT(ImagesIn(folder.path()), ElementsAre("1.png", "2.png", "4.png", "5.png"));
}

TEST(HostileFiles, TextInUtf16IsCalledThat) {
  const TempFolder folder;
  const std::string utf16(
      "\xff\xfe"
      "1\0.\0",
      6);
  const std::string list = folder.Write("tum/rgb.txt", utf16);
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { OpenSource(folder / "tum"); }),
              AllOf(HasSubstr(list), HasSubstr("UTF-16")));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(list); }), HasSubstr("UTF-16"));
  const std::string zeros = folder.Write("zeros.txt", std::string(100, '\0'));
  EXPECT_THAT(MessageOf(ErrorKind::kInput, [&] { ReadTrajectory(zeros); }),
              HasSubstr("not a text file"));
}

std::string YamlProblem(const std::string& text) {
  return MessageOf(ErrorKind::kInput, [&] { CheckYaml(text, "a.yaml"); });
}

TEST(CheckYaml, RefusesAnchorsAndAliases) {
  EXPECT_THAT(YamlProblem("x: 1\na: &a [*a]\n"), HasSubstr("a.yaml:2: anchors and aliases"));
  EXPECT_THAT(YamlProblem("a: &a 1\n"), HasSubstr("a.yaml:1: anchors"));
  EXPECT_THAT(YamlProblem("a: {&b c: 1}\n"), HasSubstr("anchors"));
  EXPECT_THAT(YamlProblem("a: *nobody\n"), HasSubstr("a.yaml:1"));
  CheckYaml("a: '*b & c'\n", "a.yaml");
}

TEST(CheckYaml, RefusesWhatGoesTooDeepOrHoldsTooMuch) {
  EXPECT_THAT(YamlProblem("\n" + std::string(100000, '[')), HasSubstr("a.yaml:2: lists or maps"));
  std::string map, list = "[";
  for (int i = 0; i < 2000; ++i) {
    map += std::string(static_cast<size_t>(i), ' ') + "a:\n";
    list += "1,1,1,1,1,1,";
  }
  EXPECT_THAT(YamlProblem(map), HasSubstr("deep"));
  EXPECT_THAT(YamlProblem(list + "1]"), HasSubstr("more than 10000 names and values"));
  CheckYaml("a: " + std::string(kMostYamlDepth - 1, '[') + std::string(kMostYamlDepth - 1, ']'),
            "a.yaml");
}

TEST(CheckYaml, RefusesANameGivenTwiceAndASecondDocument) {
  EXPECT_THAT(YamlProblem("fx: 1\nfy: 2\nfx: 3\n"), HasSubstr("a.yaml:3: `fx` is given twice"));
  EXPECT_THAT(YamlProblem("right: {fx: 1, fx: 1}\n"), HasSubstr("`fx` is given twice"));
  CheckYaml("fx: fx\nright: {fx: 1, fy: 1}\nlist: [fx, fx]\n", "a.yaml");
  EXPECT_THAT(YamlProblem("fx: 1\n---\nfx: 2\n"), HasSubstr("second document"));
  CheckYaml("---\nfx: 1\n...\n", "a.yaml");
  CheckYaml("", "a.yaml");
}

TEST(CheckYaml, EveryEditorsLineEndsAndEncodingsAreRead) {
  CheckYaml(
      "\xef\xbb\xbf"
      "fx: 1\r\nfy: 2\r\n",
      "a.yaml");
  EXPECT_THAT(YamlProblem("fx: [1\r\nfy: 2\r\n"), HasSubstr("a.yaml:"));
}

}  // namespace
}  // namespace alidade::hostile_files_test
