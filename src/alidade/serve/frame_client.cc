#include "alidade/serve/frame_client.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/error.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <utility>

namespace alidade {
namespace {

namespace frame_beast = boost::beast;
namespace frame_websocket = boost::beast::websocket;

// Bytes of a message: a JPEG of about 4 megapixels.
constexpr size_t kMostPicture = size_t{4} << 20;
constexpr size_t kMostHello = 1024;  // bytes of the first message; valid ones have about 100
// Bytes of memory that a waiting message needs besides its own: the object, and the allocator's 16.
constexpr size_t kMessageOverhead = 80;
constexpr size_t kFrameClientFrame = size_t{64} << 10;  // bytes of a WebSocket frame

// Replaces quotes, backslashes and control characters, for use in a JSON string.
std::string Harmless(const std::string& text) {
  std::string plain;
  for (const char c : text) plain += (c == '"' || c == '\\' || (c >= 0 && c < ' ')) ? ' ' : c;
  return plain;
}

}  // namespace

FrameClient::FrameClient(frame_beast::tcp_stream stream, boost::asio::io_context& io,
                         FrameHost& host, const ServeSettings& settings, bool& warned)
    : io_(io),
      host_(host),
      socket_(std::move(stream)),
      most_counted_(settings.client_bytes),
      warned_(warned) {
  const auto patience = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(settings.patience));
  frame_beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own timers
  socket_.set_option(frame_websocket::stream_base::timeout{patience, patience, true});
  socket_.read_message_max(kMostHello);
  socket_.write_buffer_bytes(kFrameClientFrame);
  socket_.auto_fragment(true);
}

void FrameClient::Start(const Request& upgrade) {
  socket_.async_accept(upgrade, [self = shared_from_this()](frame_beast::error_code error) {
    if (error) return;
    self->open_ = true;
    if (self->last_) return self->Pump();
    self->Read();
  });
}

void FrameClient::Finish() {
  seat_.reset();
  last_ = true;
  Pump();
}

void FrameClient::Read() {
  socket_.async_read(heard_, [self = shared_from_this()](frame_beast::error_code error, size_t) {
    if (error) return self->End();
    std::string bytes = frame_beast::buffers_to_string(self->heard_.cdata());
    self->heard_.consume(self->heard_.size());
    self->Hear(std::move(bytes), self->socket_.got_text());
    if (!self->last_) self->Read();
  });
}

void FrameClient::Hear(std::string bytes, bool text) {
  if (seat_) {
    if (!text) seat_->Take(std::move(bytes));
    return;
  }
  if (!text) return Refuse("the first message must be text that identifies the session");
  std::string problem;
  // Only a posted handler may hold a strong reference, so that the client is destroyed in its own
  // thread.
  seat_ = host_.Join(
      bytes,
      [told = told_, io = &io_, client = weak_from_this()](std::vector<FrameMessage> messages,
                                                           bool last) {
        {
          const std::lock_guard lock(told->mutex);
          if (told->last) return;
          told->batches.push_back(std::move(messages));
          told->last = last;
        }
        boost::asio::post(*io, [client] {
          if (const auto self = client.lock()) self->TakeTold();
        });
      },
      &problem);
  if (!seat_) return Refuse(problem);
  socket_.read_message_max(kMostPicture);
}

void FrameClient::Refuse(const std::string& why) {
  if (last_) return;
  Add({{"{\"error\":\"" + Harmless(why) + "\"}", true}});
  last_ = true;
  Pump();
}

void FrameClient::TakeTold() {
  std::vector<std::vector<FrameMessage>> batches;
  bool last = false;
  {
    const std::lock_guard lock(told_->mutex);
    batches.swap(told_->batches);
    last = told_->last;
  }
  if (last_) return;
  for (std::vector<FrameMessage>& messages : batches) {
    Add(std::move(messages));
    if (counted_ > most_counted_) return Drop();
  }
  last_ = last;
  Pump();
}

// Does not count the messages for a page that has read everything before: a slow page gets a reply
// of any size.
void FrameClient::Add(std::vector<FrameMessage> messages) {
  const bool reads = waiting_.empty();
  for (FrameMessage& message : messages) {
    const size_t counts = reads || message.of_whole ? 0 : message.bytes.size() + kMessageOverhead;
    counted_ += counts;
    waiting_.push_back({std::move(message), counts});
  }
}

void FrameClient::Drop() {
  if (!std::exchange(warned_, true)) {
    host_.Warn(
        "a page sends images and does not read the answers: it was disconnected when more "
        "than " +
        std::to_string(most_counted_ >> 20) +
        " MB waited for it (said once; the page may connect again)");
  }
  last_ = true;
  waiting_.erase(waiting_.begin() + (sending_ ? 1 : 0), waiting_.end());
  counted_ = 0;
  End();
}

void FrameClient::Pump() {
  if (!open_ || sending_) return;
  if (waiting_.empty()) {
    if (!last_) return;
    open_ = false;
    seat_.reset();
    socket_.async_close(frame_websocket::close_code::going_away,
                        [self = shared_from_this()](frame_beast::error_code) { self->End(); });
    return;
  }
  sending_ = true;
  const FrameMessage& next = waiting_.front().message;
  socket_.text(next.text);
  socket_.async_write(boost::asio::buffer(next.bytes),
                      [self = shared_from_this()](frame_beast::error_code error, size_t) {
                        self->sending_ = false;
                        self->counted_ -= std::min(self->counted_, self->waiting_.front().counts);
                        self->waiting_.pop_front();
                        if (error) return self->End();
                        self->Pump();
                      });
}

void FrameClient::End() {
  open_ = false;
  seat_.reset();
  frame_beast::get_lowest_layer(socket_).close();
}

}  // namespace alidade
