// `alidade export` and `alidade info` as a user meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <sstream>

#include "alidade/io/files/file.h"
#include "support/map_bytes.h"
#include "support/saved_map.h"
#include "support/saved_map_command.h"

namespace alidade::export_command_test {
namespace {

TEST_F(SavedMapCommand, InfoSaysWhatTheRunSaid) {
  const std::string result = Result("rgbd");
  const json info = Info(result), stats = json::parse(ReadText(result + "/stats.json"));
  EXPECT_EQ(info["sensor"], "rgbd");
  EXPECT_EQ(info["keyframes"], stats["keyframes"]);
  EXPECT_EQ(info["landmarks"], stats["landmarks"]);
  EXPECT_EQ(info["bytes"], fs::file_size(result + "/map.alidade"));
  EXPECT_EQ(info["camera"]["width"], 640);
  EXPECT_EQ(info["camera"]["distortion"].size(), 5u);
  ASSERT_EQ(info["maps"].size(), 1u);
  const json& map = info["maps"][0];
  EXPECT_EQ(map["keyframes"], info["keyframes"]);
  EXPECT_GE(map["observations"]["mean"], 1);
  EXPECT_GE(map["time"][1], 0.5);
  EXPECT_GE(map["path_length"], map["extent"][0]);
  EXPECT_EQ(map["loops"], 0);
  EXPECT_EQ(RunAlidade({"info", result + "/map.alidade", "--json"}).out,
            RunAlidade({"info", result, "--json"}).out);  // the folder or the file

  const ProgramResult table = RunAlidade({"info", result});
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.out, HasSubstr("640x480"));
  EXPECT_THAT(table.out, HasSubstr(std::to_string(info["landmarks"].get<int>()) + ", each seen"));
}

TEST_F(SavedMapCommand, AMapReadAndWrittenAgainIsTheSame) {
  for (const char* sensor : {"rgbd", "mono"}) {
    const std::string bytes = ReadText(Result(sensor) + "/map.alidade");
    const SavedMap read = DecodeMap(bytes);
    EXPECT_TRUE(EncodeMap(read) == bytes) << sensor;
    MapStore store;  // also by way of a program that goes on with it
    store.Restore(read.map);
    SavedMap again = read;
    again.map = store.Snapshot();
    EXPECT_TRUE(EncodeMap(again) == bytes) << sensor;
  }
}

// Another place added to a saved map: two maps, and nothing of either is lost in a file.
TEST_F(SavedMapCommand, AMapThatWentOnElsewhereIsTheSameWhenWrittenAgain) {
  const std::string desk = Rendered({"desk", "--frames", "20", "--distortion"});
  const std::string first = Result("rgbd"), out = folder_ / "both";
  const ProgramResult run = RunAlidade(
      {"run", desk, "--sensor", "rgbd", "--load", first + "/map.alidade", "--out", out, "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  const json before = Info(first), info = Info(out);
  EXPECT_EQ(info["maps"].size(), 2u);
  EXPECT_GT(info["keyframes"], before["keyframes"]);
  EXPECT_EQ(info["camera"], before["camera"]);
  const std::string bytes = ReadText(out + "/map.alidade");
  EXPECT_TRUE(EncodeMap(DecodeMap(bytes)) == bytes);
}

// A real kitchen, its beginning and then its end, which may be one map by then or two.
TEST_F(SavedMapCommand, ARealMapIsTheSameWhenWrittenAgain) {
  if (DataFolder().empty()) GTEST_SKIP() << "needs ALIDADE_DATA";
  const std::string kitchen = DataFolder() + "/kitchen", out = folder_ / "one";
  const ProgramResult first =
      RunAlidade({"run", kitchen, "--sensor", "mono", "--last", "119", "--out", out, "--quiet"});
  ASSERT_EQ(first.status, 0) << first.err;
  const std::string both = folder_ / "both";
  const ProgramResult second = RunAlidade({"run", kitchen, "--sensor", "mono", "--first", "480",
                                           "--load", out, "--out", both, "--quiet"});
  ASSERT_EQ(second.status, 0) << second.err;
  for (const std::string& result : {out, both}) {
    const std::string bytes = ReadText(result + "/map.alidade");
    const SavedMap read = DecodeMap(bytes);
    EXPECT_TRUE(EncodeMap(read) == bytes);
    EXPECT_GT(read.map.next_keyframe(), read.map.KeyFrames().back().value);
    EXPECT_GT(read.map.next_landmark(), 2u * static_cast<uint32_t>(read.map.landmark_count()));
  }
}

TEST_F(SavedMapCommand, AMapOfAnotherCameraIsRefused) {
  const std::string room = Rendered({"room", "--frames", "20", "--seed", "5"});  // no distortion
  ExpectRefused(
      {"run", room, "--sensor", "rgbd", "--load", Result("rgbd"), "--out", folder_ / "out"}, 3,
      "made with another camera: k1 -0.22 in the map, 0 here");
  EXPECT_FALSE(fs::exists(folder_ / "out/trajectory.txt"));
}

TEST_F(SavedMapCommand, AMapFromANewerProgramIsRefused) {
  std::string bytes = ReadText(Result("rgbd") + "/map.alidade");
  SetMapVersion(bytes, 99);
  ASSERT_TRUE(RepairChecksum(bytes));
  const std::string map = folder_.Write("new.alidade", bytes);
  ExpectRefused({"info", map}, 3, "new.alidade: the map has format version 99");
  ExpectRefused({"run", Rendered({"room", "--frames", "40", "--distortion"}), "--sensor", "rgbd",
                 "--load", map, "--out", folder_ / "out"},
                3, "version 99");
}

// Two maps in one file: the larger one is exported, or the one that is named.
TEST_F(SavedMapCommand, ExportsOneOfSeveralMaps) {
  const SavedMap saved = MakeSavedMap();  // 7 keyframes, and 4 in the second map
  const std::string map = folder_.Write("two.alidade", EncodeMap(saved));
  const json info = Info(map);
  ASSERT_EQ(info["maps"].size(), 2u);
  EXPECT_EQ(info["maps"][0]["keyframes"], 7);
  EXPECT_EQ(info["maps"][1]["keyframes"], 4);
  EXPECT_EQ(info["maps"][0]["loops"], 1);
  EXPECT_EQ(info["maps"][0]["landmarks"].get<int>() + info["maps"][1]["landmarks"].get<int>(),
            info["landmarks"]);
  EXPECT_GT(info["places"]["nodes"], 0);
  Export(map, "tum", folder_ / "a.txt");
  EXPECT_EQ(DataLines(folder_ / "a.txt").size(), 7u);
  Export(map, "tum", folder_ / "b.txt", {"--part", "1"});
  EXPECT_EQ(DataLines(folder_ / "b.txt").size(), 4u);
  Export(map, "colmap", folder_ / "model",
         {"--no-images", "--min-observations", "1", "--part", "1"});
  EXPECT_EQ(DataLines(folder_ / "model/points3D.txt").size(), info["maps"][1]["landmarks"]);
}

TEST_F(SavedMapCommand, AnEmptyMapHasNothingToExport) {
  SavedMap saved;
  saved.camera = Camera::FromFieldOfView(640, 480, 66);
  saved.sensor = "mono";
  const std::string map = folder_.Write("empty.alidade", EncodeMap(saved));
  EXPECT_EQ(Info(map)["maps"].size(), 0u);
  EXPECT_EQ(RunAlidade({"info", map}).status, 0);
  Export(map, "pcd", folder_ / "a.pcd");
  EXPECT_THAT(ReadText(folder_ / "a.pcd"), HasSubstr("POINTS 0"));
  Export(map, "colmap", folder_ / "model", {"--no-images"});
}

TEST_F(SavedMapCommand, TumIsTheTrajectoryOfTheKeyframes) {
  const std::string result = Result("rgbd");
  Export(result, "tum", folder_ / "keyframes.txt");
  const auto wanted = DataLines(result + "/keyframes.txt");
  const auto lines = DataLines(folder_ / "keyframes.txt");
  ASSERT_EQ(lines.size(), wanted.size());
  for (size_t i = 0; i < lines.size(); ++i) {
    std::istringstream a(lines[i]), b(wanted[i]);
    for (int field = 0; field < 8; ++field) {
      double x = 0, y = 1;
      a >> x;
      b >> y;
      EXPECT_NEAR(x, y, 1e-8) << lines[i];
    }
    EXPECT_EQ(lines[i].substr(0, lines[i].find(' ')), wanted[i].substr(0, wanted[i].find(' ')));
  }
}

TEST_F(SavedMapCommand, CloudsHoldTheLandmarks) {
  const std::string result = Result("rgbd");
  const int landmarks = Info(result)["landmarks"];
  Export(result, "ply", folder_ / "a.ply", {"--format", "text"});
  EXPECT_EQ(ReadText(folder_ / "a.ply"), ReadText(result + "/landmarks.ply"));
  Export(result, "ply", folder_ / "b.ply");
  EXPECT_THAT(ReadText(folder_ / "b.ply"),
              HasSubstr("element vertex " + std::to_string(landmarks) + "\n"));
  Export(result, "pcd", folder_ / "a.pcd", {"--format", "text"});
  EXPECT_EQ(ReadLines(folder_ / "a.pcd").size(), static_cast<size_t>(landmarks) + 11);
  Export(result, "pcd", folder_ / "b.pcd");
  const std::string pcd = ReadText(folder_ / "b.pcd");
  EXPECT_EQ(pcd.size(), pcd.find("DATA binary\n") + 12 + 12 * static_cast<size_t>(landmarks));
  Export(result, "pcd", folder_ / "c.pcd", {"--min-observations", "3"});
  EXPECT_LT(fs::file_size(folder_ / "c.pcd"), pcd.size());
}

TEST_F(SavedMapCommand, ColmapFolderIsReplacedOnlyWhenItIsOurs) {
  const std::string result = Result("rgbd");
  const std::string out = folder_ / "deep/model";
  Export(result, "colmap", out + "/", {"--no-images"});
  EXPECT_EQ(NamesIn(out).size(), 7u);  // the model twice, and what tells it is ours
  Export(result, "colmap", out, {"--no-images", "--format", "text"});
  EXPECT_EQ(NamesIn(out).size(), 4u);
  Export(result, "colmap", folder_.Folder("empty"), {"--no-images"});

  const std::string foreign = folder_ / "foreign";
  folder_.Write("foreign/images.txt", "months of work");
  ExpectRefused({"export", result, "--to", "colmap", foreign}, 3, "foreign");
  EXPECT_EQ(ReadText(foreign + "/images.txt"), "months of work");
  folder_.Write("deep/model/notes.txt", "dear diary");
  ExpectRefused({"export", result, "--to", "colmap", out}, 3, "other files");
  ExpectRefused({"export", result, "--to", "colmap", foreign + "/images.txt"}, 3, "file");
  ExpectRefused({"export", result, "--to", "colmap", "/proc/model"}, 3, "/proc/model");
  EXPECT_EQ(NamesIn(folder_.path()).size(), 3u);  // no drafts
  EXPECT_EQ(NamesIn(folder_ / "deep").size(), 1u);
}

TEST_F(SavedMapCommand, WhatAKilledExportLeftIsRemoved) {
  const std::string left = folder_.Folder("model.tmp99999-0");
  folder_.Write("model.tmp99999-0/images.txt", "half");
  folder_.Write("model.tmp99999-1/thesis.txt", "someone else's");
  Export(Result("rgbd"), "colmap", folder_ / "model", {"--no-images"});
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(folder_ / "model.tmp99999-1"));
}

TEST_F(SavedMapCommand, ExportsThatCannotBeAreUsageErrors) {
  const std::string map = Result("rgbd") + "/map.alidade", out = folder_ / "out";
  ExpectRefused({"export", map, "--to", "obj", out}, 2, "obj");
  ExpectRefused({"export", map, "--to", "tum", out, "--format", "binary"}, 2, "text");
  ExpectRefused({"export", map, "--to", "ply", out, "--format", "both"}, 2, "colmap");
  ExpectRefused({"export", map, "--to", "ply", out, "--part", "1"}, 2, "their number is 1");
  ExpectRefused({"export", map, "--to", "ply", map}, 2, "the map itself");
  ExpectRefused({"export", map, "--to", "ply", folder_.path()}, 3, "is a folder");
  EXPECT_TRUE(NamesIn(folder_.path()).empty());
}

TEST_F(SavedMapCommand, MapsThatAreNoneAreOneLineAndStatusThree) {
  const std::string whole = ReadText(Result("rgbd") + "/map.alidade");
  std::string damaged = whole;
  damaged[whole.size() / 2] ^= 4;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {folder_ / "nowhere.alidade", "nowhere.alidade"},
      {folder_.Folder("empty"), "map.alidade"},
      {folder_.Write("letter.txt", "Dear all, this is not a map."), "letter.txt: not a map"},
      {folder_.Write("none.alidade", ""), "none.alidade: not a map"},
      {folder_.Write("cut.alidade", whole.substr(0, whole.size() - 1000)), "cut.alidade: the map"},
      {folder_.Write("damaged.alidade", damaged), "damaged.alidade: the map is damaged"}};
  for (const auto& [map, words] : cases) {
    ExpectRefused({"info", map}, 3, words);
    ExpectRefused({"info", map, "--json"}, 3, words);
    ExpectRefused({"export", map, "--to", "ply", folder_ / "out.ply"}, 3, words);
    ExpectRefused({"export", map, "--to", "colmap", folder_ / "model"}, 3, words);
  }
  EXPECT_FALSE(fs::exists(folder_ / "out.ply"));
  EXPECT_FALSE(fs::exists(folder_ / "model"));
}

}  // namespace
}  // namespace alidade::export_command_test
