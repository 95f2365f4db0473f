// Processes the images that web pages send to the program (`alidade phone --connected`). The server
// only transports them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace alidade {

struct FrameMessage {
  std::string bytes;
  bool text = true;  // false: binary, a message of the stream
  // Part of the whole state, which a page gets once, when it joins.
  bool of_whole = false;
};

// Sends messages to the page, in order, from any thread. `last`: closes the connection afterwards.
using FrameTell = std::function<void(std::vector<FrameMessage> messages, bool last)>;

// The session of one page; ends on destruction.
class FrameSeat {
 public:
  virtual ~FrameSeat() = default;
  // A binary message of the page: a 16-byte header and a JPEG (docs/reference/phone-protocol.md).
  // Does not block.
  virtual void Take(std::string bytes) = 0;
};

class FrameHost {
 public:
  virtual ~FrameHost() = default;
  // `hello`: the page's first message, JSON. Returns null and sets `problem` when it is refused.
  // `tell` may be called until the seat is destroyed and for a short time afterwards.
  virtual std::unique_ptr<FrameSeat> Join(const std::string& hello, FrameTell tell,
                                          std::string* problem) = 0;
  // Passes a warning of the server on to the user. Any thread.
  virtual void Warn(const std::string& message) = 0;
};

}  // namespace alidade
