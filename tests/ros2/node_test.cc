// `alidade ros2` beside a camera's driver of another vendor: transforms and odometry come back.
#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <mutex>

#include "alidade/io/ros/messages/messages.h"
#include "alidade/ros/ros_log.h"
#include "problems/surface_truth.h"
#include "ros2/camera_driver.h"
#include "support/program.h"

namespace alidade {
namespace {

constexpr char kTransformType[] = "tf2_msgs::msg::dds_::TFMessage_";
constexpr char kOdometryType[] = "nav_msgs::msg::dds_::Odometry_";
constexpr char kPathType[] = "nav_msgs::msg::dds_::Path_";

class Ros2Node : public testing::Test {
 protected:
  // The driver, which publishes from now on, and what it hears.
  // The room of seed 7 is mapped to 2 cm at this size, that of seed 1 to 6 cm when images are lost.
  void Start(const std::string& scene = "room?frames=120&seed=7", bool around = false) {
    driver_ = std::make_unique<CameraDriver>(domain_, FastPeer::Quality::kBestEffort, true, scene);
    if (around) {
      driver_->GoAround();
      driver_->WaitForPoses();
    }
    driver_->Play();
    peer().Subscribe("rt/tf", kTransformType, FastPeer::Quality::kReliable, [this](std::string m) {
      driver_->PoseOf(1e-9 * static_cast<double>(FirstStampOf(m)));
      const std::lock_guard<std::mutex> lock(mutex_);
      transforms_.push_back(std::move(m));
      transform_times_.push_back(std::chrono::steady_clock::now());
      changed_.notify_all();
    });
    peer().Subscribe("rt/tf_static", kTransformType, FastPeer::Quality::kLatched,
                     [this](std::string m) {
                       const std::lock_guard<std::mutex> lock(mutex_);
                       fixed_ = std::move(m);
                     });
    peer().Subscribe("rt/alidade/odometry", kOdometryType, FastPeer::Quality::kBestEffort,
                     [this](std::string m) {
                       const std::lock_guard<std::mutex> lock(mutex_);
                       odometry_.push_back(std::move(m));
                     });
    peer().Subscribe("rt/alidade/path", kPathType, FastPeer::Quality::kReliable,
                     [this](std::string) { ++paths_; });
  }
  FastPeer& peer() { return driver_->peer(); }

  const int domain_ = UseOwnDomain();
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> transforms_, odometry_;  // guarded by mutex_, as the next two
  std::vector<std::chrono::steady_clock::time_point> transform_times_;
  std::string fixed_;
  std::atomic<int> paths_{0};
  std::unique_ptr<CameraDriver> driver_;  // last: its threads use the other members
};

TEST_F(Ros2Node, PublishesTransformsThatAgreeWithTheTruth) {
  const TempFolder out;
  Start();
  const ProgramResult result = RunAlidade(
      {"ros2", "--out", out / "run", "--mount", "0.1 0 0.4 0 0 0", "--base-frame", "robot"},
      [&](pid_t child) {
        std::unique_lock<std::mutex> lock(mutex_);
        EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(60),
                                      [&] { return transforms_.size() >= 150; }));
        lock.unlock();
        kill(child, SIGINT);
      });
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_NE(result.out.find("/cam/image_raw"), std::string::npos) << result.out;
  EXPECT_TRUE(std::filesystem::exists(out / "run/trajectory.txt"));
  const std::lock_guard<std::mutex> lock(mutex_);
  EXPECT_GE(paths_, 1);
  ASSERT_GE(odometry_.size(), 120u);

  const std::vector<RosFrame> fixed = ParseRosTransforms(fixed_, Serialization::kCdr);
  ASSERT_EQ(fixed.size(), 2u);
  EXPECT_EQ(fixed[0].child, "map_optical");
  EXPECT_EQ(fixed[1].parent, "robot");
  EXPECT_EQ(fixed[1].child, "cam_optical");
  const Se3 T_base_camera = fixed[1].T_parent_child;
  EXPECT_NEAR(T_base_camera.t.z(), 0.4, 1e-12);

  // The base moves as the truth says, and odom is continuous. On a machine that is busy the second
  // frame may be too far from the first, and the map begins again.
  constexpr size_t kBegun = 10;  // transforms
  std::optional<Se3> first, true_first, last_odom;
  double worst = 0, worst_step = 0;
  for (size_t i = kBegun; i < transforms_.size(); ++i) {
    const std::string& message = transforms_[i];
    const std::vector<RosFrame> frames = ParseRosTransforms(message, Serialization::kCdr);
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[0].parent + frames[0].child, "mapodom");
    EXPECT_EQ(frames[1].parent + frames[1].child, "odomrobot");
    const Se3 T_map_camera = frames[0].T_parent_child * frames[1].T_parent_child * T_base_camera;
    const double time = 1e-9 * static_cast<double>(FirstStampOf(message));
    const Se3 truth = *driver_->FrameAt(time).T_world_camera;
    if (!first) {
      first = T_map_camera;
      true_first = truth;
    }
    const Se3 moved = first->Inverse() * T_map_camera, true_moved = true_first->Inverse() * truth;
    worst = std::max(worst, (moved.t - true_moved.t).norm());
    const Se3& T_odom_base = frames[1].T_parent_child;
    if (last_odom) worst_step = std::max(worst_step, (last_odom->Inverse() * T_odom_base).t.norm());
    last_odom = T_odom_base;
  }
  EXPECT_LT(worst, 0.05);       // meters
  EXPECT_LT(worst_step, 0.15);  // meters: the camera's fastest step, with some frames lost
}

// The correction of a loop is in map -> odom. What odom steps is what the camera moved, which is
// too fast for a busy machine.
TEST_F(Ros2Node, ALoopIsClosedBetweenMapAndOdom) {
  if (std::getenv("ALIDADE_LONG_TESTS") == nullptr) GTEST_SKIP() << "only with scripts/test --long";
  constexpr int kRound = 1000;  // images once around
  const TempFolder out;
  Start("loop?speed=2&frames=" + std::to_string(kRound), true);
  const auto time_of = [](const std::string& message) {
    return 1e-9 * static_cast<double>(FirstStampOf(message));
  };
  const ProgramResult result = RunAlidade({"ros2", "--out", out / "run"}, [&](pid_t child) {
    std::unique_lock<std::mutex> lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(150), [&] {
      return !transforms_.empty() &&
             time_of(transforms_.back()) > CameraDriver::TimeOf(kRound + kRound / 2);
    }));
    lock.unlock();
    kill(child, SIGINT);
  });
  EXPECT_EQ(result.status, 130) << result.err;
  const std::lock_guard<std::mutex> lock(mutex_);
  const Se3 T_base_camera{BodyAxesFromOptical(), Eigen::Vector3d::Zero()};
  double worst = 0, largest = 0, beside = 0;  // meters; `beside`: error of odom at the largest
  for (size_t i = 1; i < transforms_.size(); ++i) {
    // After a loss the camera may be in another map, which has its own place in odom.
    if (time_of(transforms_[i]) - time_of(transforms_[i - 1]) > 1.5 / CameraDriver::kFps) continue;
    const auto before = ParseRosTransforms(transforms_[i - 1], Serialization::kCdr);
    const auto after = ParseRosTransforms(transforms_[i], Serialization::kCdr);
    const auto odom = [&](const std::vector<RosFrame>& frames) {
      return frames[1].T_parent_child * T_base_camera;
    };
    const Se3 truth = driver_->FrameAt(time_of(transforms_[i - 1])).T_world_camera->Inverse() *
                      *driver_->FrameAt(time_of(transforms_[i])).T_world_camera;
    const double error = ((odom(before).Inverse() * odom(after)).t - truth.t).norm();
    const double corrected =
        (before[0].T_parent_child.Inverse() * after[0].T_parent_child).t.norm();
    worst = std::max(worst, error);
    if (corrected > largest) beside = error;
    largest = std::max(largest, corrected);
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_LT(beside, 0.05);
  EXPECT_LT(worst, 0.15);
  const std::string stats = ReadText(out / "run/stats.json");
  const size_t loops = stats.find("\"loops\":");
  ASSERT_NE(loops, std::string::npos);
  EXPECT_GE(std::atoi(stats.c_str() + loops + 8), 1);
  std::printf("largest correction %.3f m, odom beside it off by %.3f, at most by %.3f\n", largest,
              beside, worst);
}

TEST_F(Ros2Node, InterruptedBeforeThereAreImagesSaysSo) {
  const TempFolder out;
  const ProgramResult result = RunAlidade({"ros2", "--out", out / "run"}, [](pid_t child) {
    std::this_thread::sleep_for(std::chrono::seconds(4));
    kill(child, SIGINT);
  });
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_NE(result.err.find("no topic with images"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("interrupted while waiting"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(out / "run"));
}

constexpr char kGridType[] = "nav_msgs::msg::dds_::OccupancyGrid_";

template <typename T>
T ValueAt(const std::string& message, size_t at) {
  T value{};
  std::memcpy(&value, message.data() + at, sizeof value);
  return value;
}

TEST_F(Ros2Node, PublishesAGridToDriveBy) {
  const TempFolder out;
  Start();
  std::string grid;  // guarded by mutex_
  std::atomic<int> grids{0};
  peer().Subscribe("rt/map", kGridType, FastPeer::Quality::kLatched, [&](std::string m) {
    const std::lock_guard<std::mutex> lock(mutex_);
    grid = std::move(m);
    ++grids;
    changed_.notify_all();
  });
  const ProgramResult result = RunAlidade(
      {"ros2", "--out", out / "run", "--grid", "--mount", "0 0 0.4 0 0 0"}, [&](pid_t child) {
        std::unique_lock<std::mutex> lock(mutex_);
        EXPECT_TRUE(changed_.wait_for(lock, std::chrono::seconds(90), [&] { return grids >= 2; }));
        lock.unlock();
        kill(child, SIGINT);
      });
  EXPECT_EQ(result.status, 130) << result.err;
  const std::lock_guard<std::mutex> lock(mutex_);
  // CDR: 4 bytes of header, stamp, frame_id ("map", 8 bytes), then the fields, each aligned.
  constexpr size_t kInfo = 4 + 8 + 8 + 8;  // after map_load_time
  ASSERT_GT(grid.size(), 200u);
  EXPECT_EQ(grid.substr(16, 3), "map");
  EXPECT_NEAR(ValueAt<float>(grid, kInfo), 0.05, 1e-6);
  const auto width = ValueAt<uint32_t>(grid, kInfo + 4),
             height = ValueAt<uint32_t>(grid, kInfo + 8);
  constexpr size_t kOrigin = kInfo + 16;  // aligned to 8 from the end of CDR's header
  const size_t cells = kOrigin + 7 * 8 + 4;
  ASSERT_LE(cells + width * height, grid.size());
  ASSERT_GT(cells + width * height + 4, grid.size());
  // The room's floor below the camera is in the plane of the grid, which was seen some meters
  // ahead: a degree of tilt is 5 cm there.
  const std::string& last = transforms_.back();
  const std::vector<RosFrame> frames = ParseRosTransforms(last, Serialization::kCdr);
  const Se3 T_base_camera{BodyAxesFromOptical(), Eigen::Vector3d(0, 0, 0.4)};
  const Se3 T_map_camera = frames[0].T_parent_child * frames[1].T_parent_child * T_base_camera;
  const double time = 1e-9 * static_cast<double>(FirstStampOf(last));
  const Se3 truth = *driver_->FrameAt(time).T_world_camera;
  const Eigen::Vector3d below(truth.t.x(), truth.t.y(), 0);
  const Eigen::Vector3d floor = T_map_camera * (truth.Inverse() * below);
  const auto value = [&](size_t i) { return ValueAt<double>(grid, kOrigin + 8 * i); };
  const Se3 corner = Se3::FromQuaternion(Eigen::Quaterniond(value(6), value(3), value(4), value(5)),
                                         {value(0), value(1), value(2)});
  EXPECT_NEAR((corner.Inverse() * floor).z(), 0, 0.1);  // meters
  const SurfaceTruth room(SynthDefaults("room"));
  const Se3 T_scene_grid = truth * T_map_camera.Inverse() * corner;
  const auto state = [&](int64_t column, int64_t row) -> int {
    const bool inside = column >= 0 && row >= 0 && column < width && row < height;
    return inside ? grid[cells + static_cast<size_t>(row * width + column)] : -1;
  };
  int free = 0, free_right = 0, occupied = 0, things = 0, things_found = 0;
  for (int64_t row = 0; row < height; ++row) {
    for (int64_t column = 0; column < width; ++column) {
      const int here = state(column, row);
      if (here < 0) continue;
      const Eigen::Vector3d p =
          T_scene_grid * Eigen::Vector3d(0.05 * (static_cast<double>(column) + 0.5),
                                         0.05 * (static_cast<double>(row) + 0.5), 0);
      const bool thing = StandsThere(room, p, 0.1, 0.9, 0.025);
      bool found = false;  // in the cell or beside it
      for (int k = 0; k < 9; ++k)
        found = found || state(column + k % 3 - 1, row + k / 3 - 1) == 100;
      free += here == 0;
      free_right += here == 0 && (!thing || found);  // within one cell, as walls
      occupied += here == 100;
      things += thing;
      things_found += thing && found;
    }
  }
  EXPECT_GT(free, 200);  // half a square meter
  EXPECT_GT(occupied, 20);
  EXPECT_GE(free_right, 0.99 * free);
  EXPECT_GE(things_found, 0.95 * things);
}

constexpr char kEmptyType[] = "std_msgs::msg::dds_::Empty_";
constexpr char kBoolType[] = "std_msgs::msg::dds_::Bool_";
constexpr char kLogType[] = "rcl_interfaces::msg::dds_::Log_";

// Commands of another node: save, stay, grow, forget. Each is answered by an event. The other node
// learns the names of both nodes of the program.
TEST_F(Ros2Node, ObeysCommands) {
  const TempFolder out;
  Start();
  std::string heard, nodes;  // guarded by mutex_
  constexpr char kNodes[] = "ros_discovery_info",
                 kNodesType[] = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";
  peer().Advertise(kNodes, kNodesType, FastPeer::Quality::kLatched, "typehash=RIHS01_0a;");
  peer().Subscribe(kNodes, kNodesType, FastPeer::Quality::kLatched, [&](std::string m) {
    const std::lock_guard<std::mutex> lock(mutex_);
    nodes += m;
  });
  peer().Subscribe("rt/alidade/events", kLogType, FastPeer::Quality::kReliable, [&](std::string m) {
    const std::lock_guard<std::mutex> lock(mutex_);
    heard += m;
    changed_.notify_all();
  });
  const int save = peer().Advertise("rt/alidade/save", kEmptyType, FastPeer::Quality::kReliable);
  const int reset = peer().Advertise("rt/alidade/reset", kEmptyType, FastPeer::Quality::kReliable);
  const int only =
      peer().Advertise("rt/alidade/localize_only", kBoolType, FastPeer::Quality::kReliable);
  const std::string saved = out / "run.alidade";
  const ProgramResult result = RunAlidade({"ros2", "--out", out / "run"}, [&](pid_t child) {
    const auto awaits = [&](const std::function<bool()>& condition) {
      std::unique_lock<std::mutex> lock(mutex_);
      return changed_.wait_for(lock, std::chrono::seconds(60), condition);
    };
    const auto answers = [&](int command, char value, const char* answer) {
      peer().Publish(command, std::string("\0\1\0\0", 4) + value);
      EXPECT_TRUE(awaits([&] { return heard.find(answer) != std::string::npos; })) << answer;
    };
    EXPECT_TRUE(awaits([&] { return transforms_.size() >= 60; }));
    answers(save, 0, "the map was saved to");
    EXPECT_GT(std::filesystem::file_size(saved), 10000u);
    answers(only, 1, "the map stays as it is");
    answers(only, 0, "the map grows again");
    answers(reset, 0, "all maps were removed");
    size_t before = 0;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      before = transforms_.size();
    }
    EXPECT_TRUE(awaits([&] { return transforms_.size() >= before + 60; }));
    kill(child, SIGINT);
  });
  EXPECT_EQ(result.status, 130) << result.err;
  for (const std::string name : {"alidade", "alidade_source"})
    EXPECT_NE(nodes.find(name + '\0'), std::string::npos) << name;
  const ProgramResult loaded = RunAlidade({"info", saved});
  EXPECT_EQ(loaded.status, 0) << loaded.err;
  // odom goes on where it was.
  std::optional<Se3> last;
  for (const std::string& message : transforms_) {
    const Se3 odom = ParseRosTransforms(message, Serialization::kCdr)[1].T_parent_child;
    EXPECT_LT((last.value_or(odom).Inverse() * odom).t.norm(), 0.15);
    last = odom;
  }
}

int64_t ResidentBytes(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/statm");
  int64_t pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

// Prints latencies, which depend on the machine.
TEST_F(Ros2Node, RunsForHalfAnHour) {
  if (std::getenv("ALIDADE_LONG_TESTS") == nullptr) GTEST_SKIP() << "only with scripts/test --long";
  const char* wanted = std::getenv("ALIDADE_ROS2_SECONDS");
  const int seconds = wanted == nullptr ? 1800 : std::atoi(wanted);
  const TempFolder out;
  Start();
  std::vector<double> latencies;
  std::vector<int64_t> resident;  // once a second
  Se3 last_odom;
  double last_time = 0, worst_speed = 0;
  const ProgramResult result = RunAlidade({"ros2", "--out", out / "run"}, [&](pid_t child) {
    for (int second = 0; second < seconds; ++second) {
      std::this_thread::sleep_for(std::chrono::seconds(1));
      resident.push_back(ResidentBytes(child));
      const std::lock_guard<std::mutex> lock(mutex_);
      for (size_t i = 0; i < transforms_.size(); ++i) {
        const double time = 1e-9 * static_cast<double>(FirstStampOf(transforms_[i]));
        latencies.push_back(
            std::chrono::duration<double, std::milli>(transform_times_[i] - driver_->SentAt(time))
                .count());
        const Se3 odom = ParseRosTransforms(transforms_[i], Serialization::kCdr)[1].T_parent_child;
        if (last_time > 0)
          worst_speed = std::max(worst_speed, (odom.t - last_odom.t).norm() / (time - last_time));
        last_odom = odom;
        last_time = time;
      }
      transforms_.clear();
      transform_times_.clear();
      odometry_.clear();
    }
    kill(child, SIGINT);
  });
  EXPECT_EQ(result.status, 130) << result.err;
  ASSERT_GT(latencies.size(), 100u);
  EXPECT_GT(latencies.size(), 0.9 * (seconds - 10) * CameraDriver::kFps);
  EXPECT_LT(worst_speed, 3);  // m/s: the rendered camera is slower than 2
  std::sort(latencies.begin(), latencies.end());
  std::printf("%zu poses; milliseconds from image to pose: median %.1f, p99 %.1f\n",
              latencies.size(), latencies[latencies.size() / 2],
              latencies[latencies.size() * 99 / 100]);
  const std::string stats = ReadText(out / "run/stats.json");
  const size_t frame = stats.find("\"median\":", stats.find("\"frame\":"));
  if (frame != std::string::npos)
    std::printf("the frame's own median: %.1f ms; fastest step of odom: %.2f m/s\n",
                std::atof(stats.c_str() + frame + 9), worst_speed);
  const size_t third = resident.size() / 3;
  const double early = 1e-6 * static_cast<double>(resident[third]);
  const double late = 1e-6 * static_cast<double>(resident.back());
  std::printf("resident: %.1f MB after a third, %.1f at the end\n", early, late);
  // Freed memory comes and goes by some megabytes; the trajectory alone would take 128 bytes per
  // frame.
  const double frames = static_cast<double>(latencies.size()) * 2 / 3;
  EXPECT_LT(late - early, 5 + 0.1e-3 * frames);
}

}  // namespace
}  // namespace alidade
