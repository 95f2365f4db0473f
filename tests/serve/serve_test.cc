// Tests the viewer's server over sockets, as browsers and other clients use it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "alidade/serve/response.h"
#include "alidade/serve/viewer_server.h"
#include "serve/counting_hub.h"
#include "serve/plain_client.h"
#include "support/expect_error.h"
#include "support/temp_folder.h"

namespace alidade::serve_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

ServeSettings AnyPort() {
  ServeSettings settings;
  settings.port = 0;
  return settings;
}

std::string BodyOf(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

constexpr char kPolicy[] =
    "Content-Security-Policy: default-src 'none'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'; script-src 'self'; style-src 'self'; img-src 'self'; "
    "connect-src 'self'; require-trusted-types-for 'script'; trusted-types 'none'\r\n";

TEST(Serve, GivesThePageWithItsPolicy) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "kitchen");
  EXPECT_EQ(server->address(), "http://127.0.0.1:" + std::to_string(server->port()) + "/");
  const std::string page = PlainClient(server->port()).Ask("GET /");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(page, HasSubstr("Content-Type: text/html; charset=utf-8\r\n"));
  for (const char* line :
       {kPolicy, "X-Content-Type-Options: nosniff\r\n", "Referrer-Policy: no-referrer\r\n",
        "Cache-Control: no-store\r\n", "Cross-Origin-Resource-Policy: same-origin\r\n"}) {
    EXPECT_THAT(page, HasSubstr(line));
  }
  EXPECT_THAT(BodyOf(page), StartsWith("<!doctype html>"));
  if (server->has_page()) {
    EXPECT_THAT(PlainClient(server->port()).Ask("GET /viewer.js"),
                HasSubstr("Content-Type: text/javascript; charset=utf-8\r\n"));
  } else {
    EXPECT_THAT(page, HasSubstr("was not built into this program"));
  }
}

TEST(Serve, GivesFilesCompressedToThoseWhoTakeThem) {
  const std::vector<PageFile> files = {{"a.js", "plain"}, {"a.js.gz", "small"}, {"b.css", "alone"}};
  EXPECT_EQ(FindPage("/a.js", files)->bytes, "plain");
  EXPECT_FALSE(FindPage("/a.js", files)->gzipped);
  EXPECT_EQ(FindPage("/a.js", files, true)->bytes, "small");
  EXPECT_TRUE(FindPage("/a.js", files, true)->gzipped);
  EXPECT_EQ(FindPage("/a.js", files, true)->type, "text/javascript; charset=utf-8");
  EXPECT_EQ(FindPage("/b.css", files, true)->bytes, "alone");
  EXPECT_FALSE(FindPage("/a.js.gz", files, true));
  for (const char* takes :
       {"gzip", "gzip, deflate, br, zstd", "br;q=1.0, gzip;q=0.2", "br,gzip;q=1"})
    EXPECT_TRUE(AcceptsGzip(takes)) << takes;
  for (const char* not_taken : {"", "identity", "gzip;q=0", "br, gzip; q=0.000", "xgzip", "gzipx"})
    EXPECT_FALSE(AcceptsGzip(not_taken)) << not_taken;

  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  if (!server->has_page()) GTEST_SKIP() << "the page is not built in";
  const std::string whole = PlainClient(server->port()).Ask("GET /viewer.js");
  const std::string host = "Host: 127.0.0.1:" + std::to_string(server->port()) + "\r\n";
  const std::string small =
      PlainClient(server->port()).Ask("GET /viewer.js", host + "Accept-Encoding: gzip\r\n");
  EXPECT_THAT(whole, testing::Not(HasSubstr("Content-Encoding")));
  EXPECT_THAT(small, HasSubstr("Content-Encoding: gzip\r\n"));
  EXPECT_THAT(BodyOf(small), StartsWith("\x1f\x8b"));
  EXPECT_LT(2 * BodyOf(small).size(), BodyOf(whole).size());
}

TEST(Serve, SaysWhatItShows) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "a \"room\" \xff");
  EXPECT_EQ(BodyOf(PlainClient(server->port()).Ask("GET /info.json")),
            "{\"mode\":\"live\",\"program\":\"alidade 0.2.0\",\"title\":\"a \\\"room\\\" "
            "\xef\xbf\xbd\"}");
}

TEST(Serve, NothingButWhatIsCompiledIn) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  for (const char* path : {"/etc/passwd", "/../../etc/passwd", "//", "/viewer.js/", "/%2e%2e/",
                           "/run.stream", "*", "http://127.0.0.1/"}) {
    EXPECT_THAT(PlainClient(server->port()).Ask("GET " + std::string(path)),
                StartsWith("HTTP/1.1 404 "))
        << path;
  }
  EXPECT_THAT(PlainClient(server->port()).Ask("POST /"), StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(PlainClient(server->port()).Ask("DELETE /run.stream"), StartsWith("HTTP/1.1 405 "));
  const std::string head = PlainClient(server->port()).Ask("HEAD /");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 "));
  EXPECT_EQ(BodyOf(head), "");
}

TEST(Serve, OneConnectionTakesSeveralRequests) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient client(server->port());
  const std::string host = " HTTP/1.1\r\nHost: " + client.Host() + "\r\n";
  client.Send("GET /info.json" + host + "\r\nHEAD /" + host + "\r\nGET /none" + host +
              "Connection: close\r\n\r\n");
  const std::string answers = client.ReceiveAll();
  EXPECT_THAT(answers, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(answers, HasSubstr("}HTTP/1.1 200 "));
  EXPECT_THAT(answers, HasSubstr("\r\n\r\nHTTP/1.1 404 "));
}

TEST(Serve, OtherHostNamesAndOriginsAreRefused) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  const std::string port = ":" + std::to_string(server->port());
  const auto status = [&](const std::string& lines) {
    return PlainClient(server->port()).Ask("GET /", lines).substr(9, 3);
  };
  const auto upgrade = [&](const std::string& lines) {
    return PlainClient(server->port()).Upgrade("/stream", lines);
  };
  EXPECT_EQ(status("Host: 127.0.0.1" + port + "\r\n"), "200");
  EXPECT_EQ(status("Host: LocalHost" + port + "\r\n"), "200");
  for (const std::string& host :
       {"evil.example" + port, std::string("127.0.0.1"), std::string("127.0.0.1:1"),
        "127.0.0.1.evil.example" + port, "192.168.0.1" + port, "0.0.0.0" + port, port,
        std::string(), "127.0.0.1" + port + "\r\nHost: 127.0.0.1" + port}) {
    EXPECT_EQ(status("Host: " + host + "\r\n"), "403") << host;
    EXPECT_EQ(upgrade("Host: " + host + "\r\n"), 403) << host;
  }
  EXPECT_EQ(PlainClient(server->port()).Upgrade(), 101);  // a program, not a web page
  EXPECT_EQ(upgrade("Origin: http://127.0.0.1" + port + "\r\n"), 101);
  for (const std::string& origin :
       {std::string("http://evil.example"), "https://127.0.0.1" + port, std::string("null"),
        std::string("http://127.0.0.1:1"), std::string("http://localhost") + port, std::string()}) {
    EXPECT_EQ(upgrade("Origin: " + origin + "\r\n"), 403) << origin;
    EXPECT_EQ(status("Origin: " + origin + "\r\n"), "403") << origin;
  }
}

TEST(Serve, BeyondThisMachineATokenIsNeeded) {
  CountingHub hub;
  ServeSettings settings = AnyPort();
  settings.host = "0.0.0.0";
  const auto server = StartViewer(settings, &hub, "", "");
  const std::string& address = server->address();
  const size_t mark = address.find("/?token=");
  ASSERT_NE(mark, std::string::npos) << address;
  const std::string query = address.substr(mark + 1), token = query.substr(7);
  EXPECT_EQ(token.size(), 32u);
  EXPECT_NE(StartViewer(settings, &hub, "", "")->address().substr(mark + 1), query);

  std::string wrong = token;
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const char* path : {"/", "/index.html", "/info.json"}) {
    const auto status = [&](const std::string& with) {
      return PlainClient(server->port()).Ask("GET " + (path + with)).substr(9, 3);
    };
    EXPECT_EQ(status(query), "200") << path;
    EXPECT_EQ(status("?a=b&" + query.substr(1) + "&c"), "200") << path;
    for (const std::string& with :
         {std::string(), std::string("?token="), "?token=" + wrong, "?token=" + token + "0",
          "?token=" + token.substr(1), "?Token=" + token, "?" + token}) {
      EXPECT_EQ(status(with), "403") << path << with;
    }
  }
  EXPECT_EQ(PlainClient(server->port()).Upgrade("/stream"), 403);
  EXPECT_EQ(PlainClient(server->port()).Upgrade("/stream?token=" + wrong), 403);
  EXPECT_EQ(PlainClient(server->port()).Upgrade("/stream" + query), 101);
}

TEST(Serve, APortInUseGivesWayToTheNext) {
  CountingHub hub;
  const auto first = StartViewer(AnyPort(), &hub, "", "");
  ServeSettings settings;
  settings.port = first->port();
  const auto second = StartViewer(settings, &hub, "", "");
  EXPECT_GT(second->port(), first->port());
  EXPECT_THAT(PlainClient(second->port()).Ask("GET /"), StartsWith("HTTP/1.1 200 "));
  settings.port_given = true;
  EXPECT_THAT(MessageOf(ErrorKind::kUsage, [&] { StartViewer(settings, &hub, "", ""); }),
              HasSubstr("127.0.0.1:" + std::to_string(first->port()) + " is in use"));
}

TEST(Serve, WhatCannotBeServedIsSaid) {
  CountingHub hub;
  const auto complaint = [&](ErrorKind kind, const ServeSettings& settings, StreamHub* live,
                             const std::string& path) {
    return MessageOf(kind, [&] { StartViewer(settings, live, path, ""); });
  };
  ServeSettings settings = AnyPort();
  EXPECT_THAT(complaint(ErrorKind::kInput, settings, nullptr, "/none"),
              HasSubstr("/none: there is no such file"));
  EXPECT_THAT(complaint(ErrorKind::kInput, settings, nullptr, "/dev/zero"), HasSubstr("/dev/zero"));
  settings.host = "198.51.100.7";  // reserved for documentation
  EXPECT_THAT(complaint(ErrorKind::kUsage, settings, &hub, ""), HasSubstr("198.51.100.7"));
  settings.host = "no host";
  EXPECT_THAT(complaint(ErrorKind::kUsage, settings, &hub, ""), HasSubstr("no host"));
  settings.host = "";
  EXPECT_THAT(complaint(ErrorKind::kUsage, settings, &hub, ""), HasSubstr("serve.host"));
  settings = AnyPort();
  settings.port = 70000;
  EXPECT_THAT(complaint(ErrorKind::kUsage, settings, &hub, ""), HasSubstr("serve.port"));
}

TEST(Serve, AReplayIsTheFileAsItIs) {
  TempFolder folder;
  const std::string path = folder.path() + "/run.stream";
  std::string bytes;
  for (int i = 0; i < 700000; ++i) bytes += static_cast<char>(i % 251);
  std::ofstream(path, std::ios::binary) << bytes;
  const auto server = StartViewer(AnyPort(), nullptr, path, "");
  EXPECT_THAT(PlainClient(server->port()).Ask("GET /info.json"), HasSubstr("\"mode\":\"replay\""));
  const std::string answer = PlainClient(server->port()).Ask("GET /run.stream");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(answer.substr(0, answer.find("\r\n\r\n")), HasSubstr("Content-Length: 700000\r\n"));
  EXPECT_TRUE(BodyOf(answer) == bytes);
  EXPECT_EQ(BodyOf(PlainClient(server->port()).Ask("HEAD /run.stream")), "");
  EXPECT_EQ(PlainClient(server->port()).Upgrade(), 404);
}

TEST(ServeStream, MessagesComeInOrderAndLateJoinersGetTheWhole) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient early(server->port()), late(server->port());
  ASSERT_EQ(early.Upgrade(), 101);
  EXPECT_EQ(early.Message(), "hello");
  EXPECT_EQ(early.Message(), "whole 0");
  for (int i = 0; i < 100; ++i) hub.Tell();
  for (int i = 1; i <= 100; ++i) ASSERT_EQ(early.Message(), std::to_string(i));
  ASSERT_EQ(late.Upgrade(), 101);
  EXPECT_EQ(late.Message(), "hello");
  EXPECT_EQ(late.Message(), "whole 100");
  EXPECT_EQ(server->viewers(), 2);
  hub.Tell();
  EXPECT_EQ(early.Message(), "101");
  EXPECT_EQ(late.Message(), "101");
}

TEST(ServeStream, AMessageOfAnySizeComesWhole) {
  CountingHub hub(3000001);
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient client(server->port());
  ASSERT_EQ(client.Upgrade(), 101);
  for (const char* start : {"hello ", "whole 0 "}) {
    const auto message = client.Message();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->size(), 3000001u);
    EXPECT_EQ(message->substr(0, std::string(start).size()), start);
  }
}

TEST(ServeStream, ViewersMayAskAndNothingElse) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient client(server->port());
  ASSERT_EQ(client.Upgrade(), 101);
  for (const char* text : {"", "{", "[]", "pause", "{\"do\":\"quit\"}", "{\"do\":1}",
                           "{\"do\":\"pause\",\"x\":1}", "{\"do\":\"PAUSE\"}"}) {
    client.Say(text);
  }
  client.Send(PlainClient::Frame(2, "{\"do\":\"pause\"}"));  // not sent as text
  client.Say("{\"do\":\"step\"}");
  client.Say(" { \"do\" : \"pause\" }\n");
  client.Say("{\"do\":\"resume\"}");
  EXPECT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.controls().size() >= 3; }));
  EXPECT_THAT(hub.controls(), testing::ElementsAre(StreamControl::kStep, StreamControl::kPause,
                                                   StreamControl::kResume));
}

TEST(ServeStream, WhoAsksTooMuchIsClosed) {
  CountingHub hub;
  const auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient large(server->port()), often(server->port());
  ASSERT_EQ(large.Upgrade(), 101);
  large.Say(std::string(1025, 'x'));
  while (large.Message()) {
  }
  EXPECT_EQ(large.close_code(), 1009);
  ASSERT_EQ(often.Upgrade(), 101);
  // More than 100 per second, on any machine that processes 10,000 within 100 s.
  std::string frames;
  for (int i = 0; i < 10000; ++i) frames += PlainClient::Frame(1, "{\"do\":\"pause\"}");
  often.Send(frames);
  while (often.Message()) {
  }
  EXPECT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 0; }));
}

TEST(ServeStream, TooManyViewersAreTurnedAway) {
  CountingHub hub;
  ServeSettings settings = AnyPort();
  settings.max_clients = 2;
  const auto server = StartViewer(settings, &hub, "", "");
  PlainClient third(server->port());
  {
    PlainClient first(server->port()), second(server->port());
    ASSERT_EQ(first.Upgrade(), 101);
    ASSERT_EQ(second.Upgrade(), 101);
    EXPECT_EQ(third.Upgrade(), 503);
  }
  ASSERT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 0; }));
  EXPECT_EQ(PlainClient(server->port()).Upgrade(), 101);
}

TEST(ServeStream, TheEndIsToldAfterWhatWaits) {
  CountingHub hub;
  auto server = StartViewer(AnyPort(), &hub, "", "");
  PlainClient client(server->port());
  ASSERT_EQ(client.Upgrade(), 101);
  ASSERT_EQ(client.Message(), "hello");
  ASSERT_EQ(client.Message(), "whole 0");
  for (int i = 0; i < 50; ++i) hub.Tell();
  std::thread end([&] { server.reset(); });
  for (int i = 1; i <= 50; ++i) EXPECT_EQ(client.Message(), std::to_string(i));
  EXPECT_EQ(client.Message(), std::nullopt);
  EXPECT_EQ(client.close_code(), 1001);
  end.join();
  EXPECT_TRUE(hub.WaitFor([](const CountingHub& h) { return h.members() == 0; }));
}

}  // namespace
}  // namespace alidade::serve_test
