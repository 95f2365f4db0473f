// Who works on pictures that pages send to the program (`alidade phone --connected`): the server
// carries, a FrameHost does the work.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace alidade {

struct FrameMessage {
  std::string bytes;
  bool text = true;  // else binary: a message of the stream
};

// To the page, from any thread, in order. `last`: nothing follows, the connection is closed.
using FrameTell = std::function<void(std::vector<FrameMessage> messages, bool last)>;

// One page's seat, until it is destroyed.
class FrameSeat {
 public:
  virtual ~FrameSeat() = default;
  // A binary message of the page (docs/reference/phone-protocol.md). Returns at once.
  virtual void Take(std::string bytes) = 0;
};

class FrameHost {
 public:
  virtual ~FrameHost() = default;
  // `hello`: the page's first message, JSON. Null when it cannot be, and `problem` says why. The
  // seat's owner may be called back until it has destroyed the seat, and a moment longer.
  virtual std::unique_ptr<FrameSeat> Join(const std::string& hello, FrameTell tell,
                                          std::string* problem) = 0;
};

}  // namespace alidade
