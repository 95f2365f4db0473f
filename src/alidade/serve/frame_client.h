// One page that sends its pictures: they go to the FrameHost, what that tells comes back.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <memory>
#include <string>

#include "alidade/serve/frame_host.h"
#include "alidade/serve/viewer_server.h"

namespace alidade {

// Everything but what the host calls happens in the one thread of the io_context. What waits to be
// sent is bounded by what the page has sent: two pictures at a time are answered, more are not
// taken.
class FrameClient : public std::enable_shared_from_this<FrameClient> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  FrameClient(boost::beast::tcp_stream stream, boost::asio::io_context& io, FrameHost& host,
              const ServeSettings& settings);
  FrameClient(const FrameClient&) = delete;
  FrameClient& operator=(const FrameClient&) = delete;

  void Start(const Request& upgrade);
  void Finish();  // says good-bye

 private:
  void Read();
  void Hear(std::string bytes, bool text);
  void Add(std::vector<FrameMessage> messages, bool last);
  void Refuse(const std::string& why);
  void Pump();  // sends the next message, if there is one and nothing is being sent
  void End();

  boost::asio::io_context& io_;
  FrameHost& host_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer heard_;
  std::unique_ptr<FrameSeat> seat_;
  std::deque<FrameMessage> waiting_;
  bool open_ = false, sending_ = false, last_ = false;
};

}  // namespace alidade
