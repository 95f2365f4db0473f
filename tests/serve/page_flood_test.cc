// `alidade phone --connected` with a page that sends and does not read: the answers that wait for
// it are limited.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <string>

#include "alidade/serve/viewer_server.h"
#include "phone_host.h"
#include "serve/plain_client.h"
#include "support/expect_error.h"

namespace alidade::page_flood_test {
namespace {

using ::testing::HasSubstr;

// What the address sanitizer adds: 32 MB of freed memory that it keeps (scripts/sanitize), and the
// margins of all allocations.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define WITH_ADDRESS_SANITIZER
#endif
#endif
#ifdef WITH_ADDRESS_SANITIZER
constexpr size_t kOfSanitizer = size_t{64} << 20;
#else
constexpr size_t kOfSanitizer = 0;
#endif

// Resident memory of this process, bytes.
size_t ResidentBytes() {
  size_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * 4096;
}

std::string Hello(char digit) {
  return "{\"session\": \"" + std::string(32, digit) +
         "\", \"width\": 320, \"height\": 240, \"fov\": 60}";
}

TEST(PageFlood, APageThatDoesNotReadIsDisconnectedAndItsSessionStays) {
  const WarningCatcher warnings;
  PhoneHost host({});
  ServeSettings settings;
  settings.port = 0;
  settings.patience = 600;  // do not close it for its silence
  const auto server = StartPhonePage(settings, "", &host);
  const size_t before = ResidentBytes();
  // An image that was sent before; the answer to it is longer than the message.
  std::string image(17, '\0');
  std::string thousand;
  for (int i = 0; i < 1000; ++i) thousand += PlainClient::Frame(2, image);
  for (const char digit : {'a', 'b'}) {
    PlainClient page(server->port(), 65536);
    ASSERT_EQ(page.Upgrade("/frames"), 101);
    ASSERT_TRUE(page.Say(Hello(digit)));
    int sent = 0;
    while (sent < 2000 && page.Send(thousand)) ++sent;
    EXPECT_LT(sent, 2000) << "46 MB were sent, and all answers were kept";
  }
  // Twice 4 MiB of answers, and what the allocator and two sessions use.
  EXPECT_LT(ResidentBytes() - before, (size_t{64} << 20) + kOfSanitizer);
  const std::string text = warnings.text();
  const size_t first = text.find("does not read");
  EXPECT_NE(first, std::string::npos) << text;
  EXPECT_EQ(text.find("does not read", first + 1), std::string::npos) << "said once: " << text;

  PlainClient back(server->port());
  ASSERT_EQ(back.Upgrade("/frames"), 101);
  back.Say(Hello('a'));
  EXPECT_THAT(back.Message().value_or(""), HasSubstr("\"resumed\":true"));
}

TEST(PageFlood, TheFirstMessageIsShort) {
  PhoneHost host({});
  ServeSettings settings;
  settings.port = 0;
  const auto server = StartPhonePage(settings, "", &host);
  PlainClient page(server->port());
  ASSERT_EQ(page.Upgrade("/frames"), 101);
  page.Say(Hello('a') + std::string(100000, ' '));
  EXPECT_EQ(page.Message(), std::nullopt);
  EXPECT_EQ(page.close_code(), 1009);
}

}  // namespace
}  // namespace alidade::page_flood_test
