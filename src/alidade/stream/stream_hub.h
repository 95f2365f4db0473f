// Where the messages of a stream can be had while it runs, for those who carry them somewhere.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace alidade {

enum class StreamControl { kPause, kResume, kStep };

class StreamHub {
 public:
  virtual ~StreamHub() = default;

  // Messages are shared by all who take them, and never change.
  using Take = std::function<void(const std::shared_ptr<const std::string>& message)>;

  // `take` is given all that was told so far (hello, the whole map, events, how it is played),
  // before this returns, then every message as it comes, one call at a time, from any thread, until
  // Leave() has returned. It must be quick: everybody waits for it. Any thread may call; `take`
  // itself must not.
  virtual int Join(Take take) = 0;
  virtual void Leave(int id) = 0;

  // What a viewer asks of the run. Without effect where that cannot be (a camera). Any thread.
  virtual void Control(StreamControl control) = 0;
};

}  // namespace alidade
