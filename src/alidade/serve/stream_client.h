// Connection of one viewer: sends the hub's messages over its WebSocket and passes its commands to
// the hub.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string_view>

#include "alidade/serve/client_queue.h"
#include "alidade/serve/viewer_server.h"

namespace alidade {

// Runs in the thread of the io_context, except for the callback that the hub calls.
class StreamClient : public std::enable_shared_from_this<StreamClient> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  // `viewers`: number of connected viewers, updated.
  StreamClient(boost::beast::tcp_stream stream, boost::asio::io_context& io, StreamHub& hub,
               const ServeSettings& settings, std::shared_ptr<std::atomic<int>> viewers);
  ~StreamClient();
  StreamClient(const StreamClient&) = delete;
  StreamClient& operator=(const StreamClient&) = delete;

  void Start(const Request& upgrade);
  void Finish();  // sends queued messages, then closes gracefully

 private:
  void Read();
  void Hear(std::string_view text);
  void Pump();  // sends the next message unless one is being sent
  void Join();
  void Leave();
  void Close(boost::beast::websocket::close_code code);
  void End();

  boost::asio::io_context& io_;
  StreamHub& hub_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer heard_;
  std::shared_ptr<ClientQueue> queue_;
  std::shared_ptr<std::atomic<int>> viewers_;
  std::optional<int> joined_;  // id assigned by the hub
  ClientQueue::Message sending_;
  bool open_ = false;
  bool finishing_ = false;
  bool wants_whole_ = false;
  bool counted_ = false;
  // Start of the second in which `asked_` commands arrived.
  std::chrono::steady_clock::time_point second_{};
  std::chrono::steady_clock::time_point whole_at_{};
  int asked_ = 0;
};

}  // namespace alidade
