// Connection of one web page that sends its images: passes them to the FrameHost and the replies
// back.
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

// Runs in the thread of the io_context, except for the callback that the host calls. The page sends
// at most two images ahead of their replies, which bounds the outgoing queue.
class FrameClient : public std::enable_shared_from_this<FrameClient> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  FrameClient(boost::beast::tcp_stream stream, boost::asio::io_context& io, FrameHost& host,
              const ServeSettings& settings);
  FrameClient(const FrameClient&) = delete;
  FrameClient& operator=(const FrameClient&) = delete;

  void Start(const Request& upgrade);
  void Finish();  // closes the connection gracefully

 private:
  void Read();
  void Hear(std::string bytes, bool text);
  void Add(std::vector<FrameMessage> messages, bool last);
  void Refuse(const std::string& why);
  void Pump();  // sends the next message unless one is being sent
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
