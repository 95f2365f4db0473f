// Answers what clients send by POST (`alidade serve`). The server transports, and limits what is in
// memory.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace alidade {

struct PostRequest {
  std::string query;  // of the address, without ?
  std::string type;   // Content-Type; empty: none
  std::string body;
};

struct PostAnswer {
  int status = 200;
  std::string json;
};

// From any thread, once. It may be called after the server has ended, and then does nothing.
using PostReply = std::function<void(PostAnswer answer)>;

class PostHost {
 public:
  virtual ~PostHost() = default;
  // The only address that takes a POST, such as "/localize".
  virtual std::string_view path() const = 0;
  virtual size_t most_bytes() const = 0;  // of a body
  // Does not block. Returns false if too much is waiting: the client is told to try again.
  virtual bool Take(PostRequest request, PostReply reply) = 0;
};

}  // namespace alidade
