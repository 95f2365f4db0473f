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
#include <mutex>
#include <string>
#include <vector>

#include "alidade/serve/frame_host.h"
#include "alidade/serve/viewer_server.h"

namespace alidade {

// Runs in the thread of the io_context, except for the callback that the host calls. A page that
// sends images and does not read the replies is disconnected when more than
// ServeSettings::client_bytes wait for it; its session stays, so that it can come back.
class FrameClient : public std::enable_shared_from_this<FrameClient> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  FrameClient(boost::beast::tcp_stream stream, boost::asio::io_context& io, FrameHost& host,
              const ServeSettings& settings, bool& warned);
  FrameClient(const FrameClient&) = delete;
  FrameClient& operator=(const FrameClient&) = delete;

  void Start(const Request& upgrade);
  void Finish();  // closes the connection gracefully

 private:
  // What the host has told from any thread, in order. asio::post() alone would not keep the order
  // of two threads.
  struct Told {
    std::mutex mutex;
    std::vector<std::vector<FrameMessage>> batches;
    bool last = false;
  };
  struct Waiting {
    FrameMessage message;
    size_t counts;  // bytes
  };

  void Read();
  void Hear(std::string bytes, bool text);
  void TakeTold();
  void Add(std::vector<FrameMessage> messages);
  void Refuse(const std::string& why);
  void Pump();  // sends the next message unless one is being sent
  void Drop();  // the page does not read
  void End();

  boost::asio::io_context& io_;
  FrameHost& host_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  boost::beast::flat_buffer heard_;
  std::unique_ptr<FrameSeat> seat_;
  const std::shared_ptr<Told> told_ = std::make_shared<Told>();
  std::deque<Waiting> waiting_;  // the first one is being sent
  size_t counted_ = 0;           // sum of `counts`
  const size_t most_counted_;
  bool& warned_;  // of the server: a dropped page was reported
  bool open_ = false, sending_ = false, last_ = false;
};

}  // namespace alidade
