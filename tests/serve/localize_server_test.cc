// Tests `alidade serve` over sockets: pictures, refusals, many clients, malformed requests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

#include "alidade/io/files/image_codec.h"
#include "alidade/run/service/localize_host.h"
#include "alidade/serve/viewer_server.h"
#include "serve/plain_client.h"
#include "support/exif.h"
#include "support/read_text.h"
#include "support/room_map.h"
#include "support/temp_folder.h"

namespace alidade::localize_server_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Service {
  explicit Service(const LocalizeHostSettings& settings = {},
                   const std::string& address = "127.0.0.1")
      : host(Map(), "room", settings) {
    ServeSettings serving;
    serving.port = 0;
    serving.host = address;
    server = StartPostPage(serving, host.Info(), &host);
  }
  static const SavedMap& Map() {
    static const SavedMap map = MapOfRoom(Sensor::kRgbd, 40).saved;
    return map;
  }
  int port() const { return server->port(); }

  LocalizeHost host;
  std::unique_ptr<ViewerServer> server;  // ends first
};

// A phone's picture of the room as JPEG, of 400 x 300 pixels and 75 degrees.
const std::string& Photo() {
  static const std::string photo = [] {
    SynthSettings camera;
    camera.width = 400;
    camera.height = 300;
    camera.fov = 75;
    camera.frames = 40;
    return EncodeJpeg(SynthRecording(camera).Render(10).image, 90);
  }();
  return photo;
}

std::string PostText(const std::string& target, const std::string& host, const std::string& body,
                     const std::string& lines = "") {
  return "POST " + target + " HTTP/1.1\r\nHost: " + host + "\r\n" + lines +
         "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

struct Reply {
  int status = 0;
  std::string head, body;
  json told() const { return json::parse(body, nullptr, false); }
};

Reply ReplyOf(const std::string& answer) {
  Reply reply;
  const size_t end = answer.find("\r\n\r\n");
  if (answer.size() < 12 || end == std::string::npos) return reply;
  reply.status = std::atoi(answer.c_str() + 9);
  reply.head = answer.substr(0, end + 2);
  reply.body = answer.substr(end + 4);
  return reply;
}

Reply PostTo(int port, const std::string& target, const std::string& body,
             const std::string& lines = "") {
  PlainClient client(port);
  client.Send(PostText(target, client.Host(), body, "Connection: close\r\n" + lines));
  return ReplyOf(client.ReceiveAll());
}

// Without the time it took.
json Untimed(json told) {
  told.erase("milliseconds");
  return told;
}

TEST(LocalizeServer, AnswersAPictureWithItsPose) {
  const Service service;
  const Reply reply = PostTo(service.port(), "/localize?fov=75", Photo());
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_THAT(reply.head, HasSubstr("Content-Type: application/json\r\n"));
  const json told = reply.told();
  EXPECT_EQ(told["placed"], true) << reply.body;
  EXPECT_EQ(told["position"].size(), 3U);
  EXPECT_EQ(told["quaternion"].size(), 4U);
  EXPECT_EQ(told["covariance"].size(), 6U);
  EXPECT_EQ(told["unit"], "meters");
  EXPECT_GE(told["probability"], 0.99);
  const json by_focal =
      PostTo(service.port(), "/localize?f=260.6&cx=199.5&cy=149.5", Photo()).told();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(by_focal["position"][i].get<double>(), told["position"][i].get<double>(), 0.01);
  }
  const std::string bare = EncodePng(cv::Mat(240, 320, CV_8UC1, cv::Scalar(80)));
  const json blank = PostTo(service.port(), "/localize?camera=map", bare).told();
  EXPECT_EQ(blank["placed"], false);
  EXPECT_EQ(blank["reason"], "blank");
  EXPECT_THAT(blank["why"], HasSubstr("too little texture"));
}

// By the focal length in 35 mm equivalents of its EXIF data.
TEST(LocalizeServer, TakesTheLensFromThePhoto) {
  const Service service;
  const std::string photo = Photo().substr(0, 2) + Exif(23) + Photo().substr(2);
  const Reply reply = PostTo(service.port(), "/localize", photo);
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(reply.told()["placed"], true) << reply.body;
  // 23 mm of a diagonal of 43.27 mm are 266 of 500 pixels; the photo has 260.6.
  EXPECT_NEAR(reply.told()["camera"]["fx"].get<double>(), 265.8, 0.5);
}

// The first Python block of the guide as it stands, but for the address.
TEST(LocalizeServer, AnswersTheGuidesClient) {
  const Service service;
  std::string guide = ReadText(ALIDADE_SOURCE_DIR "/docs/guides/localize.md");
  const size_t begin = guide.find("```python\n") + 10;
  std::string code = guide.substr(begin, guide.find("```", begin) - begin);
  const std::string address = "http://127.0.0.1:8090/localize?fov=66";
  const size_t at = code.find(address);
  ASSERT_NE(at, std::string::npos) << code;
  code.replace(at, address.size(),
               "http://127.0.0.1:" + std::to_string(service.port()) + "/localize?fov=75");
  const TempFolder folder;
  std::ofstream(folder / "client.py") << code;
  std::ofstream(folder / "photo.jpg", std::ios::binary) << Photo();
  const std::string run = "cd '" + folder.path() + "' && python3 client.py > out.txt 2>&1";
  ASSERT_EQ(std::system(run.c_str()), 0) << ReadText(folder / "out.txt");
  const json position = json::parse(ReadText(folder / "out.txt"), nullptr, false);
  EXPECT_EQ(position, PostTo(service.port(), "/localize?fov=75", Photo()).told()["position"]);
}

TEST(LocalizeServer, OneConnectionSendsSeveralPictures) {
  const Service service;
  PlainClient client(service.port());
  client.Send(PostText("/localize?fov=75", client.Host(), Photo()) +
              PostText("/localize?fov=75", client.Host(), Photo(), "Connection: close\r\n"));
  const std::string answers = client.ReceiveAll();
  const size_t second = answers.find("HTTP/1.1 200 OK", 10);
  ASSERT_NE(second, std::string::npos) << answers;
  const Reply one = ReplyOf(answers.substr(0, second)), two = ReplyOf(answers.substr(second));
  EXPECT_EQ(Untimed(one.told()), Untimed(two.told()));

  PlainClient curl(service.port());  // sends the picture after it was asked to
  const std::string whole = PostText("/localize?fov=75", curl.Host(), Photo(),
                                     "Connection: close\r\nExpect: 100-continue\r\n");
  curl.Send(whole.substr(0, whole.find("\r\n\r\n") + 4));
  ASSERT_TRUE(curl.ReceiveBytes(25));
  curl.Send(Photo());
  const std::string answer = curl.ReceiveAll();
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 200 OK\r\n"));
}

TEST(LocalizeServer, ShowsAPageAndWhatTheMapIs) {
  const Service service;
  const std::string page = PlainClient(service.port()).Ask("GET /");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(page, HasSubstr("script-src 'self'"));
  EXPECT_THAT(PlainClient(service.port()).Ask("GET /localize.js"), HasSubstr("'use strict'"));
  const json map = ReplyOf(PlainClient(service.port()).Ask("GET /map.json")).told();
  EXPECT_EQ(map["name"], "room");
  EXPECT_EQ(map["sensor"], "rgbd");
  EXPECT_EQ(map["camera"]["width"], 320);
  EXPECT_EQ(map["maps"][0]["keyframes"], map["keyframes"]);
}

TEST(LocalizeServer, SaysWhatIsWrong) {
  const Service service;
  const std::string cut = Photo().substr(0, Photo().size() / 2);
  const struct {
    const char* target;
    std::string body;
    int status;
    const char* words;
  } cases[] = {
      {"/", Photo(), 404, "/localize"},
      {"/localize", Photo(), 400, "does not tell its focal length"},
      {"/localize?fov=75", "", 400, "no picture"},
      {"/localize?fov=75", "hello", 415, "JPEG or PNG"},
      {"/localize?fov=75", cut, 422, "damaged"},
      {"/localize?fov=75", "\xff\xd8\xff", 422, "damaged"},
      {"/localize?fov=0", Photo(), 400, "fov must be positive"},
      {"/localize?fov=180", Photo(), 400, "below 180"},
      {"/localize?fov=1e999", Photo(), 400, "fov must be a number"},
      {"/localize?fov=75&f=260", Photo(), 400, "twice"},
      {"/localize?fov=75&fov=75", Photo(), 400, "twice"},
      {"/localize?fo=75", Photo(), 400, "unknown name"},
      {"/localize?fov=%7", Photo(), 400, "escape"},
      {"/localize?camera=mine", Photo(), 400, "camera must be map"},
      {"/localize?f=260&model=mirror", Photo(), 400, "pinhole or fisheye"},
      {"/localize?k1=0.1", Photo(), 400, "tell the lens"},
      {"/localize?f=260&k1=-9", Photo(), 400, "the request"},
      {"/localize?f=260&width=300&height=300", Photo(), 400, "300x300"},
      {"/localize?f=260&width=1e9", Photo(), 400, "whole number"},
  };
  for (const auto& one : cases) {
    const Reply reply = PostTo(service.port(), one.target, one.body);
    EXPECT_EQ(reply.status, one.status) << one.target << ' ' << reply.body;
    EXPECT_THAT(reply.body, HasSubstr(one.words)) << one.target;
  }
  const auto status = [&](const std::string& first, const std::string& lines) {
    return ReplyOf(PlainClient(service.port()).Ask(first, lines)).status;
  };
  EXPECT_EQ(status("GET /localize", ""), 405);
  EXPECT_EQ(status("PUT /localize", ""), 405);
  EXPECT_EQ(status("POST /localize", ""), 411);
  EXPECT_EQ(status("POST /localize", "Transfer-Encoding: chunked\r\n"), 411);
  EXPECT_EQ(status("POST /localize", "Content-Length: 99999999999\r\n"), 413);
  EXPECT_EQ(status("POST /localize", "Content-Length: -1\r\n"), 400);
  EXPECT_EQ(status("GET /map.json", "Content-Length: 5\r\n"), 413);
  EXPECT_EQ(
      PostTo(service.port(), "/localize?fov=75", Photo(), "Origin: http://a.example\r\n").status,
      403);
}

TEST(LocalizeServer, BeyondThisMachineATokenIsNeeded) {
  const Service service({}, "0.0.0.0");
  const std::string& address = service.server->address();
  const std::string token = address.substr(address.find("token="));
  EXPECT_EQ(PostTo(service.port(), "/localize?fov=75", Photo()).status, 403);
  EXPECT_EQ(PostTo(service.port(), "/localize?fov=75&" + token, Photo()).status, 200);
  EXPECT_EQ(ReplyOf(PlainClient(service.port()).Ask("GET /map.json")).status, 403);
  EXPECT_EQ(ReplyOf(PlainClient(service.port()).Ask("GET /localize.js")).status, 200);
}

TEST(LocalizeServer, ManyClientsGetTheAnswersOfOne) {
  const Service service;
  const json alone = Untimed(PostTo(service.port(), "/localize?fov=75", Photo()).told());
  std::vector<std::thread> clients;
  std::array<int, 8> same{};
  for (int& count : same) {
    clients.emplace_back([&] {
      for (int i = 0; i < 5; ++i)
        count += Untimed(PostTo(service.port(), "/localize?fov=75", Photo()).told()) == alone;
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_THAT(same, testing::Each(5));
}

TEST(LocalizeServer, TellsClientsToComeAgainWhenTooManyWait) {
  LocalizeHostSettings settings;
  settings.threads = 1;
  settings.most_waiting = 2;
  const Service service(settings);
  std::vector<std::unique_ptr<PlainClient>> clients;
  for (int i = 0; i < 12; ++i) {
    clients.push_back(std::make_unique<PlainClient>(service.port()));
    clients.back()->Send(
        PostText("/localize?fov=75", clients.back()->Host(), Photo(), "Connection: close\r\n"));
  }
  int answered = 0, refused = 0;
  for (auto& client : clients) {
    const Reply reply = ReplyOf(client->ReceiveAll());
    answered += reply.status == 200;
    if (reply.status != 503) continue;
    ++refused;
    EXPECT_THAT(reply.head, HasSubstr("Retry-After: 1\r\n"));
  }
  EXPECT_GE(answered, 1);
  EXPECT_EQ(answered + refused, 12);
}

TEST(LocalizeServer, EndsWhilePicturesWait) {
  for (int i = 0; i < 3; ++i) {
    Service service;
    PlainClient client(service.port());
    for (int k = 0; k < 5; ++k) client.Send(PostText("/localize?fov=75", client.Host(), Photo()));
    if (i > 0) client.Receive();
  }
}

size_t ResidentKilobytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    size_t kilobytes = 0;
    if (word == "VmRSS:" && status >> kilobytes) return kilobytes;
  }
  return 0;
}

// 1,000 requests; 10,000 with ALIDADE_LONG_TESTS=1.
TEST(LocalizeServer, OutlivesMalformedRequests) {
  const Service service;
  const json before = Untimed(PostTo(service.port(), "/localize?fov=75", Photo()).told());
  const int count = std::getenv("ALIDADE_LONG_TESTS") ? 10000 : 1000;
  std::mt19937 random(7);
  const auto below = [&](size_t n) {
    return std::uniform_int_distribution<size_t>(0, n - 1)(random);
  };
  const std::string host = PlainClient(service.port()).Host();
  const std::string good = PostText("/localize?f=260.6&k1=0.01&cx=199.5", host, Photo());
  size_t settled = 0;
  for (int i = 0; i < count; ++i) {
    std::string bad = good;
    const size_t head = bad.find("\r\n\r\n") + 4;
    switch (below(5)) {
      case 0:  // damaged head
        for (size_t k = 0; k <= below(4); ++k) bad[below(head)] = static_cast<char>(below(256));
        break;
      case 1:  // damaged picture, mostly its header
        for (size_t k = 0; k <= below(8); ++k)
          bad[head + below(below(2) ? 600 : bad.size() - head)] = static_cast<char>(below(256));
        break;
      case 2:  // another length than it tells
        bad.resize(below(bad.size()));
        break;
      case 3:  // bytes that are doubled or missing
        bad.insert(below(bad.size()), bad.substr(below(head), below(64)));
        bad.erase(below(head), below(16));
        break;
      default:  // noise
        bad.resize(below(2000));
        for (char& c : bad) c = static_cast<char>(below(256));
    }
    PlainClient client(service.port());
    client.Send(bad);
    client.EndOfSending();
    client.ReceiveAll();
    if (i == count / 4) settled = ResidentKilobytes();
  }
  EXPECT_LT(ResidentKilobytes(), settled + 16384);
  EXPECT_EQ(Untimed(PostTo(service.port(), "/localize?fov=75", Photo()).told()), before);
}

}  // namespace
}  // namespace alidade::localize_server_test
