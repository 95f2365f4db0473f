// Exports of a map that knows gravity stand upright; without it they stay in the map's world.
#include <Eigen/Geometry>
#include <cmath>
#include <sstream>

#include "alidade/io/cloud.h"
#include "alidade/io/files/trajectory_file.h"
#include "alidade/map/map_file.h"
#include "support/read_text.h"
#include "support/saved_map_command.h"

namespace alidade::upright_export_test {
namespace {

const Eigen::Vector3d kDown = Eigen::Vector3d(0.2, 0.8, -0.5).normalized();

class UprightExport : public SavedMapCommand {
 protected:
  // A copy of a run of one camera whose map knows meters and gravity.
  void SetUp() override {
    fs::copy(plain_, result_, fs::copy_options::recursive);
    SavedMap saved = DecodeMap(ReadText(result_ + "/map.alidade"));
    MapStore store;
    store.Restore(saved.map);
    saved.map = store.Commit([](MapCommit& commit) {
      commit.SetWorld({{0}, true, 0.01, kDown, 0.002});
    });
    std::ofstream(result_ + "/map.alidade", std::ios::binary) << EncodeMap(saved);
  }
  std::string Exported(const std::string& to, const std::vector<std::string>& options = {}) {
    const std::string out = folder_ / ("out" + std::to_string(count_++));
    Export(result_, to, out, options);
    return out;
  }
  // Rotation of the world between two exports of the same poses; checks that there is one.
  static Eigen::Matrix3d TurnBetween(const std::string& before, const std::string& after) {
    const Trajectory a = ReadTrajectory(before), b = ReadTrajectory(after);
    EXPECT_EQ(a.size(), b.size());
    EXPECT_GT(a.size(), 5u);
    const Eigen::Matrix3d R = b.front().T_world_camera.R * a.front().T_world_camera.R.transpose();
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      EXPECT_LT((R * a[i].T_world_camera.t - b[i].T_world_camera.t).norm(), 1e-6);
      EXPECT_LT((R * a[i].T_world_camera.R - b[i].T_world_camera.R).norm(), 1e-6);
    }
    return R;
  }
  const std::string plain_ = Result("mono"), result_ = folder_ / "knows";
  int count_ = 0;
};

TEST_F(UprightExport, TrajectoriesAndPointsHaveZUp) {
  for (const char* to : {"tum", "evo"}) {  // keyframes, and all frames
    const Eigen::Matrix3d R = TurnBetween(Exported(to, {"--up", "map"}), Exported(to));
    EXPECT_LT((R * kDown + Eigen::Vector3d::UnitZ()).norm(), 1e-6) << to;
    const std::string before = Exported("ply", {"--up", "map"}), after = Exported("ply");
    const Cloud a = DecodePly(ReadText(before), before), b = DecodePly(ReadText(after), after);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (size_t i = 0; i < a.points.size(); ++i) {
      const Eigen::Vector3d turned = R * a.points[i].cast<double>();
      EXPECT_LT((turned - b.points[i].cast<double>()).norm(), 1e-4 * (1 + turned.norm()));
    }
  }
}

TEST_F(UprightExport, ModelsOfImagesHaveYDown) {
  const auto points = [&](const std::vector<std::string>& options) {
    std::vector<Eigen::Vector3d> all;
    for (const std::string& line : DataLines(Exported("colmap", options) + "/points3D.txt")) {
      int id = 0;
      Eigen::Vector3d p;
      std::istringstream(line) >> id >> p.x() >> p.y() >> p.z();
      all.push_back(p);
    }
    return all;
  };
  const auto a = points({"--no-images", "--up", "map"}), b = points({"--no-images"});
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 100u);
  for (size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(kDown.dot(a[i]), b[i].y(), 1e-5 * (1 + a[i].norm()));
}

TEST_F(UprightExport, SaysMetersAndWhichWayIsUp) {
  const ProgramResult known = RunAlidade({"export", result_, "--to", "evo", folder_ / "known.txt"});
  EXPECT_THAT(known.out, HasSubstr("in meters, z up by gravity"));
  const ProgramResult unknown =
      RunAlidade({"export", plain_, "--to", "evo", folder_ / "unknown.txt"});
  EXPECT_THAT(unknown.out, testing::Not(HasSubstr("meters")));
  ExpectRefused({"export", plain_, "--to", "evo", folder_ / "x.txt", "--up", "gravity"}, 2,
                "does not know gravity");
}

TEST_F(UprightExport, InfoTellsWhatIsKnown) {
  const json known = Info(result_)["maps"][0], unknown = Info(plain_)["maps"][0];
  EXPECT_EQ(known["meters"], true);
  EXPECT_NEAR(known["gravity"][1].get<double>(), kDown.y(), 1e-12);
  EXPECT_EQ(known["gravity_sigma"], 0.002);
  EXPECT_EQ(known["scale_sigma"], 0.01);
  EXPECT_EQ(unknown["meters"], false);
  EXPECT_TRUE(unknown["gravity"].is_null());
  const ProgramResult words = RunAlidade({"info", result_});
  EXPECT_THAT(words.out, HasSubstr("meters, known to 1.0 %"));
}

}  // namespace
}  // namespace alidade::upright_export_test
