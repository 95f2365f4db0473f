// The program tells each pose as it comes.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <set>

#include "support/program.h"

namespace alidade::poses_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr char kDesk[] = "synth:desk?frames=20&width=320&height=240&seed=3";

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (size_t at = 0; at < text.size();) {
    const size_t end = text.find('\n', at);
    lines.push_back(text.substr(at, end - at));
    if (end == std::string::npos) break;
    at = end + 1;
  }
  return lines;
}

// Receives what is sent to a port of its own.
class UdpListener {
 public:
  UdpListener() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    socklen_t size = sizeof address;
    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  ~UdpListener() { close(socket_); }
  UdpListener(const UdpListener&) = delete;
  UdpListener& operator=(const UdpListener&) = delete;

  std::string port() const { return std::to_string(port_); }
  // All that has come.
  std::vector<std::string> Take() {
    std::vector<std::string> datagrams;
    char bytes[8192];
    for (ssize_t got; (got = recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT)) >= 0;)
      datagrams.emplace_back(bytes, static_cast<size_t>(got));
    return datagrams;
  }

 private:
  int socket_, port_ = 0;
};

TEST(Poses, OnTheStandardOutputAreTheLinesOfTheLiveTrajectory) {
  const TempFolder folder;
  const auto run =
      RunAlidade({"run", kDesk, "--sensor", "rgbd", "--poses", "-", "--out", folder / "out"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string live = ReadText(folder / "out/trajectory_live.txt");
  EXPECT_EQ(LineCount(run.out), 20);
  EXPECT_EQ(run.out, live.substr(live.find('\n') + 1));
  // What is usually printed there.
  EXPECT_THAT(run.err, HasSubstr("20 of 20 frames tracked"));
}

TEST(Poses, OfFramesWithoutOneSayWhy) {
  const TempFolder folder;
  const auto run = RunAlidade({"run", "synth:desk?frames=20&width=320&height=240&seed=3",
                               "--sensor", "mono", "--poses", "-", "--out", folder / "out"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::vector<std::string> lines = LinesOf(run.out);
  ASSERT_EQ(lines.size(), 20u);
  EXPECT_EQ(lines[0], "# 0.000000 initializing first_view");
  EXPECT_THAT(lines[19], testing::Not(StartsWith("#")));
}

TEST(Poses, ComeAsOneDatagramEach) {
  const TempFolder folder;
  UdpListener listener;
  const auto run = RunAlidade({"run", kDesk, "--sensor", "rgbd", "--poses",
                               "udp:127.0.0.1:" + listener.port(), "--out", folder / "out"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("20 of 20 frames tracked"));
  std::string all;
  const std::vector<std::string> datagrams = listener.Take();
  EXPECT_EQ(datagrams.size(), 20u);
  for (const std::string& datagram : datagrams) {
    EXPECT_EQ(LineCount(datagram), 1);
    all += datagram;
  }
  const std::string live = ReadText(folder / "out/trajectory_live.txt");
  EXPECT_EQ(all, live.substr(live.find('\n') + 1));
}

TEST(Poses, AsJsonHaveStateAndCovariance) {
  const TempFolder folder;
  UdpListener listener;
  const auto run = RunAlidade({"run", kDesk, "--sensor", "rgbd", "--quiet", "--poses",
                               "json:udp:localhost:" + listener.port(), "--out", folder / "out"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::vector<std::string> datagrams = listener.Take();
  ASSERT_EQ(datagrams.size(), 20u);
  const std::set<std::string> keys = {"frame",   "time",     "stamp",      "state",
                                      "pose",    "map",      "covariance", "probability",
                                      "matches", "keyframe", "failure",    "predicted"};
  for (size_t i = 0; i < datagrams.size(); ++i) {
    const auto told = nlohmann::json::parse(datagrams[i]);
    std::set<std::string> found;
    for (const auto& [key, value] : told.items()) found.insert(key);
    EXPECT_EQ(found, keys);
    EXPECT_EQ(told["frame"], i);
    EXPECT_EQ(told["state"], "tracking");
    EXPECT_EQ(told["pose"].size(), 7u);
    EXPECT_TRUE(told["failure"].is_null());
    if (i == 0) continue;  // its pose is the identity by definition
    ASSERT_EQ(told["covariance"].size(), 36u);
    for (size_t row = 0; row < 6; ++row) {
      EXPECT_GT(told["covariance"][7 * row].get<double>(), 0);
      EXPECT_NEAR(told["covariance"][row].get<double>(), told["covariance"][6 * row].get<double>(),
                  1e-12);
    }
  }
}

TEST(Poses, ThatNobodyReadsAnyMoreCostNoResult) {
  const TempFolder folder;
  const std::string command = std::string("'") + ALIDADE_BINARY + "' run '" + kDesk +
                              "' --sensor rgbd --poses - --out '" + (folder / "out") + "' 2>'" +
                              (folder / "err") + "' | head -n 1";
  const auto run = RunProgram("/bin/sh", {"-c", command});
  EXPECT_EQ(LineCount(run.out), 1);
  EXPECT_THAT(ReadText(folder / "err"), HasSubstr("20 of 20 frames tracked"));
  EXPECT_EQ(LineCount(ReadText(folder / "out/trajectory.txt")), 21);
}

TEST(Poses, ThatHaveNowhereToGoAreRefusedBeforeTheRun) {
  const TempFolder folder;
  for (const char* where :
       {"", "udp", "udp:", "udp:localhost", "udp:localhost:", "udp::5005", "udp:localhost:0",
        "udp:localhost:70000", "udp:localhost:x", "tcp:localhost:1", "json:", "poses.txt"}) {
    const auto run = RunAlidade({"run", kDesk, "--poses", where, "--out", folder / "out"});
    EXPECT_EQ(run.status, 2) << where << ": " << run.err;
    EXPECT_THAT(run.err, HasSubstr("--poses")) << where;
  }
  const auto run = RunAlidade(
      {"run", kDesk, "--poses", "udp:no.such.host.invalid:5005", "--out", folder / "out"});
  EXPECT_EQ(run.status, 3);
  EXPECT_THAT(run.err, HasSubstr("no.such.host.invalid"));
}

}  // namespace
}  // namespace alidade::poses_test
