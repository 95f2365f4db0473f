// One HTTP connection: answers requests one after the other until it closes or is upgraded to a
// WebSocket.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "alidade/serve/response.h"
#include "alidade/serve/server.h"

namespace alidade {

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(boost::asio::ip::tcp::socket socket, ServerCore& core);
  ~HttpSession();
  void Start();
  void Close();
  // Time of the last activity.
  std::chrono::steady_clock::time_point active() const { return active_; }
  // A request had the token; without a token: there was a request for what would need it.
  bool admitted() const { return admitted_; }

 private:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  void Read();
  void OnHead();
  void OnRequest();
  // Of a POST, in this order. `ReadBody`: the head is accepted.
  void OnPostHead();
  void ReadBody();
  void OnPost();
  void OnAnswer(const PostAnswer& answer);
  void Release();  // what the body took of ServerCore::posted_bytes
  void OnBadRequest(boost::beast::error_code error);
  std::string Refusal(const Request& request) const;
  void Upgrade();
  void UpgradeFrames();
  // false: it was answered with a refusal.
  bool Admit(const Request& request);
  void Send(int status, std::string_view type, std::string_view body, bool gzipped = false);
  Site site() const;
  void SendFile(const std::string& path, std::string_view type);
  void SendPart();
  void Sent(boost::beast::error_code error);
  void Linger();
  void Wake();  // restarts the timeout
  void Wake(double seconds);
  double Age() const;  // seconds since the connection was accepted

  ServerCore& core_;
  boost::beast::tcp_stream stream_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> post_;
  std::shared_ptr<size_t> posted_bytes_;  // ServerCore::posted_bytes, which may end before
  size_t reserved_ = 0;                   // bytes of these
  std::chrono::steady_clock::time_point active_, accepted_;
  bool admitted_ = false;
  bool keep_alive_ = false;
  bool head_only_ = false;
  std::string head_;
  std::string text_;        // body generated for this request
  std::ifstream file_;      // file being sent
  uint64_t file_left_ = 0;  // bytes left to send
  std::vector<char> part_;
  std::array<char, 4096> scratch_;
};

}  // namespace alidade
