#include "alidade/serve/stream_client.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/beast/websocket/error.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <string>
#include <utility>

namespace alidade {
namespace {

namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using Clock = std::chrono::steady_clock;

constexpr size_t kMostHeard = 1024;  // bytes of a message; valid ones have about 20
constexpr int kMostAsked = 100;      // messages per second; a key held down repeats at 30 Hz
// Bytes of a WebSocket frame. With small frames the connection to a slow viewer is checked between
// frames, not only after a whole message.
constexpr size_t kFrameBytes = size_t{64} << 10;
constexpr auto kBetweenWholes = std::chrono::seconds(1);

}  // namespace

StreamClient::StreamClient(beast::tcp_stream stream, boost::asio::io_context& io, StreamHub& hub,
                           const ServeSettings& settings, std::shared_ptr<std::atomic<int>> viewers)
    : io_(io),
      hub_(hub),
      socket_(std::move(stream)),
      queue_(std::make_shared<ClientQueue>(settings.client_bytes)),
      viewers_(std::move(viewers)) {
  const auto patience =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(settings.patience));
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own timers
  socket_.set_option(websocket::stream_base::timeout{patience, patience, true});
  socket_.read_message_max(kMostHeard);
  socket_.write_buffer_bytes(kFrameBytes);
  socket_.auto_fragment(true);
  socket_.binary(true);
}

StreamClient::~StreamClient() {
  Leave();
  if (counted_) --*viewers_;
}

void StreamClient::Start(const Request& upgrade) {
  socket_.async_accept(upgrade, [self = shared_from_this()](beast::error_code error) {
    if (error) return;
    if (self->finishing_) return self->End();
    self->open_ = self->counted_ = true;
    ++*self->viewers_;
    self->Join();
    self->Read();
    self->Pump();
  });
}

void StreamClient::Finish() {
  finishing_ = true;
  Leave();
  Pump();
}

void StreamClient::Read() {
  socket_.async_read(heard_, [self = shared_from_this()](beast::error_code error, size_t) {
    if (error) return self->End();
    const auto bytes = self->heard_.cdata();
    if (self->socket_.got_text())
      self->Hear({static_cast<const char*>(bytes.data()), bytes.size()});
    self->heard_.consume(self->heard_.size());
    const auto now = Clock::now();
    if (now - self->second_ >= std::chrono::seconds(1)) {
      self->second_ = now;
      self->asked_ = 0;
    }
    if (++self->asked_ > kMostAsked) return self->Close(websocket::close_code::policy_error);
    self->Read();
  });
}

// Handles {"do":"pause"} and similar commands, with or without spaces; ignores anything else.
void StreamClient::Hear(std::string_view text) {
  std::string plain;
  std::copy_if(text.begin(), text.end(), std::back_inserter(plain),
               [](char c) { return c != ' ' && c != '\t' && c != '\r' && c != '\n'; });
  if (plain == R"({"do":"pause"})") hub_.Control(StreamControl::kPause);
  if (plain == R"({"do":"resume"})") hub_.Control(StreamControl::kResume);
  if (plain == R"({"do":"step"})") hub_.Control(StreamControl::kStep);
  if (plain == R"({"do":"whole"})") {
    wants_whole_ = true;
    Pump();
  }
}

void StreamClient::Pump() {
  if (!open_) return;
  const bool behind = queue_->behind();
  if (behind) Leave();  // leave early, so that the hub does not send messages that are discarded
  if (sending_) return;
  if (!finishing_ && (behind || (wants_whole_ && Clock::now() - whole_at_ >= kBetweenWholes))) {
    Leave();
    Join();
  }
  wants_whole_ = false;
  sending_ = queue_->Pop();
  if (!sending_) {
    if (finishing_) Close(websocket::close_code::going_away);
    return;
  }
  socket_.async_write(boost::asio::buffer(*sending_),
                      [self = shared_from_this()](beast::error_code error, size_t) {
                        self->sending_.reset();
                        if (error) return self->End();
                        self->Pump();
                      });
}

void StreamClient::Join() {
  whole_at_ = Clock::now();
  queue_->Begin();
  // Only a posted handler may hold a strong reference, so that the client is destroyed in its own
  // thread.
  joined_ = hub_.Join(
      [queue = queue_, io = &io_, client = weak_from_this()](const ClientQueue::Message& message) {
        if (!queue->Push(message)) return;
        boost::asio::post(*io, [client] {
          if (const auto self = client.lock()) self->Pump();
        });
      });
  queue_->Joined();
}

void StreamClient::Leave() {
  if (joined_) hub_.Leave(*joined_);
  joined_.reset();
}

void StreamClient::Close(websocket::close_code code) {
  if (!std::exchange(open_, false)) return;
  Leave();
  socket_.async_close(code, [self = shared_from_this()](beast::error_code) { self->End(); });
}

void StreamClient::End() {
  open_ = false;
  Leave();
  if (std::exchange(counted_, false)) --*viewers_;
  beast::get_lowest_layer(socket_).close();
}

}  // namespace alidade
