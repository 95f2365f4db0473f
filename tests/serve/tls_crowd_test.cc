// `alidade phone --tls` with a crowd of connections that never show the token: whoever has it is
// served.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <string>
#include <vector>

#include "alidade/serve/viewer_server.h"
#include "phone_host.h"
#include "serve/plain_client.h"
#include "serve/tls_client.h"

namespace alidade::tls_crowd_test {
namespace {

constexpr size_t kCrowd = 300;  // more than ServeSettings::max_connections

class TlsCrowd : public ::testing::Test {
 protected:
  TlsCrowd() {
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    descriptors_ = limit.rlim_cur;
  }

  void Start(double patience) {
    ServeSettings settings;
    settings.port = 0;
    settings.host = "0.0.0.0";
    settings.tls = true;
    settings.patience = patience;
    server_ = StartPhonePage(settings, "", &host_);
    token_ = server_->address().substr(server_->address().find("/?"));
  }

  rlim_t descriptors_ = 0;
  PhoneHost host_{{}};
  std::unique_ptr<ViewerServer> server_;
  std::string token_;  // "/?token=…"
};

TEST_F(TlsCrowd, ConnectionsWithoutAHandshakeLockNobodyOut) {
  if (descriptors_ < 2500) GTEST_SKIP() << "too few descriptors (ulimit -n)";
  Start(600);
  TlsClient page(server_->port());
  ASSERT_EQ(page.Ask(token_), 200);
  std::vector<TlsClient> crowd;
  for (size_t i = 0; i < kCrowd; ++i) crowd.emplace_back(server_->port(), false);
  EXPECT_EQ(TlsClient(server_->port()).Ask(token_), 200);
  EXPECT_EQ(page.Ask(token_), 200);
}

TEST_F(TlsCrowd, ConnectionsWithoutTheTokenLockNobodyOut) {
  if (descriptors_ < 2500) GTEST_SKIP() << "too few descriptors (ulimit -n)";
  Start(600);
  TlsClient page(server_->port());
  ASSERT_EQ(page.Ask(token_), 200);
  std::vector<TlsClient> crowd;
  // Every second one asks for a file that needs no token.
  for (size_t i = 0; i < kCrowd; ++i) {
    crowd.emplace_back(server_->port());
    if (i % 2 == 0) crowd.back().Ask("/phone.js");
  }
  EXPECT_EQ(TlsClient(server_->port()).Ask(token_), 200);
  EXPECT_EQ(page.Ask(token_), 200) << "it was silent longest, but has shown the token";
}

TEST_F(TlsCrowd, WhoDoesNotShowTheTokenIsClosed) {
  Start(600);
  TlsClient silent(server_->port(), false), secure(server_->port());
  ASSERT_TRUE(secure.Secure());
  EXPECT_TRUE(silent.IsClosed());
  EXPECT_TRUE(secure.IsClosed());
  // A connection that goes on asking for files without the token is closed as well.
  TlsClient asking(server_->port());
  while (asking.Ask("/none") == 404) usleep(100000);
  EXPECT_TRUE(asking.IsClosed());
}

}  // namespace
}  // namespace alidade::tls_crowd_test
