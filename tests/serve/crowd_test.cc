// The viewer's server with malicious and stalled clients: it continues to serve the others, and its
// memory is bounded.
#include <dlfcn.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <vector>

#include "alidade/base/random.h"
#include "alidade/serve/client_queue.h"
#include "alidade/serve/viewer_server.h"
#include "serve/counting_hub.h"
#include "serve/plain_client.h"

// Connections that could not be accepted for lack of a descriptor.
static std::atomic<int> accepts_without_descriptor = 0;

// Stands before the C library's for the server's module too, since test_serve exports its symbols.
extern "C" [[gnu::visibility("default")]] int accept(int listener, sockaddr* address,
                                                     socklen_t* length) {
  using Accept = int (*)(int, sockaddr*, socklen_t*);
  static const auto next = reinterpret_cast<Accept>(dlsym(RTLD_NEXT, "accept"));
  const int connection = next(listener, address, length);
  if (connection < 0 && errno == EMFILE) ++accepts_without_descriptor;
  return connection;
}

namespace alidade::crowd_test {
namespace {

using ::testing::StartsWith;

ServeSettings AnyPort() {
  ServeSettings settings;
  settings.port = 0;
  return settings;
}

// Resident memory of this process, bytes.
size_t MemoryInUse() {
  size_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * 4096;
}

// Raises the limit of file descriptors to the maximum and returns it.
size_t RaiseDescriptors() {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  return limit.rlim_cur;
}

TEST(ClientQueue, HoldsWhatItMayAndForgetsAllBeyond) {
  const auto message = std::make_shared<const std::string>(400, 'x');
  ClientQueue queue(1000);
  queue.Begin();
  for (int i = 0; i < 10; ++i) queue.Push(message);  // the whole state does not count
  queue.Joined();
  EXPECT_FALSE(queue.behind());
  EXPECT_EQ(queue.waiting_bytes(), 4000u);
  EXPECT_FALSE(queue.Push(message));  // the first message already woke the consumer
  EXPECT_FALSE(queue.Push(message));
  EXPECT_TRUE(queue.Push(message));
  EXPECT_TRUE(queue.behind());
  EXPECT_EQ(queue.waiting_bytes(), 0u);
  EXPECT_FALSE(queue.Push(message));
  EXPECT_EQ(queue.Pop(), nullptr);
  EXPECT_EQ(message.use_count(), 1);
  queue.Begin();
  queue.Joined();
  EXPECT_TRUE(queue.Push(message));
  EXPECT_EQ(queue.Pop(), message);
  EXPECT_FALSE(queue.Push(message));  // the consumer is active
  EXPECT_EQ(queue.Pop(), message);
  EXPECT_EQ(queue.Pop(), nullptr);
  EXPECT_TRUE(queue.Push(std::make_shared<const std::string>(5000, 'x'))) << "alone, any size goes";
  EXPECT_FALSE(queue.behind());
}

// 400 MB are sent while one viewer does not read: its memory is bounded, and it gets the whole
// state when it reads again. The other viewer misses nothing.
TEST(ServeCrowd, AStoppedViewerCostsLittleAndHarmsNobody) {
  constexpr int kTold = 4000;
  CountingHub hub(100000);
  ServeSettings settings = AnyPort();
  settings.client_bytes = 1 << 20;
  settings.patience = 600;  // do not close the stalled one
  const auto server = StartViewer(settings, &hub, "", "");
  PlainClient reader(server->port()), stopped(server->port(), 65536);
  ASSERT_EQ(reader.Upgrade(), 101);
  ASSERT_EQ(stopped.Upgrade(), 101);
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(reader.Message());
  const size_t before = MemoryInUse();
  size_t most = 0, most_memory = 0;
  for (int i = 1; i <= kTold; ++i) {
    hub.Tell();
    const auto message = reader.Message();
    ASSERT_TRUE(message);
    ASSERT_EQ(message->substr(0, message->find(' ')), std::to_string(i));
    most = std::max(most, hub.living_bytes());
    most_memory = std::max(most_memory, MemoryInUse());
  }
  // For each viewer 1 MB, the two messages of the whole state, and the one being sent.
  EXPECT_LE(most, size_t{2} * ((1 << 20) + 3 * 100000));
  EXPECT_GT(most, size_t{1} << 19) << "the viewer had not stopped";
  RecordProperty("memory_growth_kb",
                 static_cast<int>((most_memory - std::min(most_memory, before)) >> 10));

  // It reads on: old messages in transit, then the current whole state.
  bool whole = false;
  while (!whole) {
    const auto message = stopped.Message();
    ASSERT_TRUE(message);
    whole = message->rfind("whole " + std::to_string(kTold) + " ", 0) == 0;
  }
  hub.Tell();
  EXPECT_THAT(*stopped.Message(), StartsWith(std::to_string(kTold + 1) + " "));
  EXPECT_EQ(server->viewers(), 2);
}

TEST(ServeCrowd, WhoGivesNoSignOfLifeIsClosed) {
  CountingHub hub(100000);
  ServeSettings settings = AnyPort();
  settings.patience = 1;
  const auto server = StartViewer(settings, &hub, "", "");
  PlainClient silent(server->port()), half(server->port()), stopped(server->port(), 65536);
  half.Send("GET / HTTP/1.1\r\nHost: ");
  ASSERT_EQ(stopped.Upgrade(), 101);
  ASSERT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 1; }));
  EXPECT_EQ(silent.ReceiveAll(), "");
  EXPECT_EQ(half.ReceiveAll(), "");
  EXPECT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 0; }));
  // A viewer that answers pings stays connected for longer than the others could.
  PlainClient alive(server->port());
  ASSERT_EQ(alive.Upgrade(), 101);
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(alive.Message());
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::seconds(3));
    hub.Tell();
  });
  const auto told = alive.Message();
  later.join();
  ASSERT_TRUE(told);
  EXPECT_THAT(*told, StartsWith("1 "));
}

TEST(ServeCrowd, AThousandWhoStaySilent) {
  const size_t descriptors = RaiseDescriptors();
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient viewer(server->port());
  ASSERT_EQ(viewer.Upgrade(), 101);
  std::vector<PlainClient> silent;
  const size_t count = std::min<size_t>(1000, descriptors / 4);
  for (size_t i = 0; i < count; ++i) silent.emplace_back(server->port());
  EXPECT_THAT(PlainClient(server->port()).Ask("GET /"), StartsWith("HTTP/1.1 200 "));
  for (const char* text : {"hello", "whole 0"}) EXPECT_EQ(viewer.Message(), text);
  hub.Tell();
  EXPECT_EQ(viewer.Message(), "1");
  // The longest idle connections were closed to make room, the newest were not.
  EXPECT_EQ(silent.front().ReceiveAll(), "");
  EXPECT_THAT(silent.back().Ask("GET /"), StartsWith("HTTP/1.1 200 "));
}

TEST(ServeCrowd, AThousandViewers) {
  if (RaiseDescriptors() < 2500) GTEST_SKIP() << "too few descriptors (ulimit -n)";
  CountingHub hub(200);
  ServeSettings settings = AnyPort();
  settings.max_clients = 1000;
  settings.max_connections = 1100;
  const auto server = StartViewer(settings, &hub, "", "");
  const size_t before = MemoryInUse();
  std::vector<PlainClient> viewers;
  for (int i = 0; i < 1000; ++i) {
    viewers.emplace_back(server->port());
    ASSERT_EQ(viewers.back().Upgrade(), 101);
  }
  ASSERT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 1000; }));
  for (int i = 0; i < 10; ++i) hub.Tell();
  for (PlainClient& viewer : viewers) {
    std::optional<std::string> last;
    for (int i = 0; i < 12; ++i) last = viewer.Message();
    ASSERT_TRUE(last);
    ASSERT_THAT(*last, StartsWith("10 "));
  }
  EXPECT_EQ(server->viewers(), 1000);
  RecordProperty("memory_growth_kb", static_cast<int>((MemoryInUse() - before) >> 10));
}

// After a failed accept the server must wait, or it would fully load a core.
TEST(ServeCrowd, OutOfDescriptorsItWaitsForSome) {
#ifdef __SANITIZE_ADDRESS__
  // UBSan probes memory through a pipe; without a descriptor for it, it considers every object
  // invalid.
  GTEST_SKIP() << "the sanitizers need descriptors of their own";
#endif
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient(server->port()).Ask("GET /");
  const int free = dup(0);
  close(free);
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const rlimit before = limit;
  limit.rlim_cur = static_cast<rlim_t>(free) + 1;
  setrlimit(RLIMIT_NOFILE, &limit);
  PlainClient client(server->port());  // uses the last descriptor
  accepts_without_descriptor = 0;
  std::this_thread::sleep_for(std::chrono::seconds(1));
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_THAT(client.Ask("GET /"), StartsWith("HTTP/1.1 200 "));
  // One each 0.1 s, of which a busy machine may make several seconds; without a rest a million.
  EXPECT_GE(accepts_without_descriptor, 1);
  EXPECT_LT(accepts_without_descriptor, 1000);
}

TEST(ServeCrowd, TheEndIsSoonWhoeverHangs) {
  CountingHub hub(3000000);
  std::vector<PlainClient> hanging;
  {
    const auto server = StartViewer(AnyPort(), &hub, "", "");
    for (int i = 0; i < 3; ++i) hanging.emplace_back(server->port(), 65536);
    EXPECT_EQ(hanging[0].Upgrade(), 101);  // does not read
    ASSERT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 1; }));
    hanging[1].Send("GET / HTTP/1.1\r\n");
  }
  EXPECT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 0; }));
  EXPECT_EQ(hanging[1].ReceiveAll(), "");
}

// Nearly valid requests reach deeper than random ones: changes, inserts and removes bytes of valid
// requests.
std::string Spoiled(std::string bytes, Random& random) {
  const uint32_t times = 1 + random.Below(6);
  for (uint32_t i = 0; i < times && !bytes.empty(); ++i) {
    const size_t at = random.Below(static_cast<uint32_t>(bytes.size()));
    const char byte = static_cast<char>(random.Below(256));
    switch (random.Below(5)) {
      case 0:
        bytes[at] = byte;
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.Below(8)));
        break;
      case 2:
        bytes.insert(at, random.Below(50), byte);
        break;
      case 3:
        bytes.erase(at, random.Below(20));
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

TEST(ServeCrowd, MalformedRequestsAndFrames) {
  const int rounds = std::getenv("ALIDADE_LONG_TESTS") != nullptr ? 10000 : 2000;
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient viewer(server->port());
  ASSERT_EQ(viewer.Upgrade(), 101);
  for (const char* text : {"hello", "whole 0"}) ASSERT_EQ(viewer.Message(), text);
  Random random(7);
  for (int round = 1; round <= rounds; ++round) {
    PlainClient client(server->port());
    std::string bytes;
    if (round % 2 == 0) {
      bytes = "GET /" + std::string(round % 4 == 0 ? "stream" : "") +
              " HTTP/1.1\r\nHost: " + client.Host() +
              "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
              "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
              "Content-Length: 0\r\n\r\n";
      if (round % 50 == 0) bytes.insert(16, std::string(random.Below(20000), 'a'));
    } else {
      ASSERT_EQ(client.Upgrade(), 101);
      for (int opcode : {1, 2, 0, 9, 10, 8})
        bytes += PlainClient::Frame(opcode, "{\"do\":\"step\"}");
      if (round % 51 == 0) bytes.insert(0, PlainClient::Frame(1, std::string(70000, 'a')));
    }
    client.Send(Spoiled(bytes, random));
    client.EndOfSending();
    client.ReceiveAll();
    if (round % 500 == 0) {
      hub.Tell();
      ASSERT_EQ(viewer.Message(), std::to_string(round / 500));
    }
  }
  EXPECT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 1; }));
  EXPECT_THAT(PlainClient(server->port()).Ask("GET /"), StartsWith("HTTP/1.1 200 "));
}

}  // namespace
}  // namespace alidade::crowd_test
