// One connection: requests are read, and answered, one after the other, until it ends or becomes a
// viewer's WebSocket.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <chrono>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/serve/server.h"

namespace alidade {

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(boost::asio::ip::tcp::socket socket, ServerCore& core);
  void Start();
  void Close();
  // When it last did something.
  std::chrono::steady_clock::time_point active() const { return active_; }

 private:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  void Read();
  void OnRequest();
  void OnBadRequest(boost::beast::error_code error);
  std::string Refusal(const Request& request) const;
  void Upgrade();
  void UpgradeFrames();
  void Send(int status, std::string_view type, std::string_view body, bool gzipped = false);
  void SendFile(const std::string& path, std::string_view type);
  void SendPart();
  void Sent(boost::beast::error_code error);
  void Linger();
  void Wake();  // the time that is left to the next step starts anew

  ServerCore& core_;
  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  std::chrono::steady_clock::time_point active_;
  bool keep_alive_ = false;
  bool head_only_ = false;
  std::string head_;
  std::string text_;        // of an answer made for this request
  std::ifstream file_;      // being sent,
  uint64_t file_left_ = 0;  // bytes
  std::vector<char> part_;
  std::array<char, 4096> scratch_;
};

}  // namespace alidade
