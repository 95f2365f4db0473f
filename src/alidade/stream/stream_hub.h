// Gives access to the messages of a running stream.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace alidade {

enum class StreamControl { kPause, kResume, kStep };

class StreamHub {
 public:
  virtual ~StreamHub() = default;

  // Messages are immutable and shared by all receivers.
  using Take = std::function<void(const std::shared_ptr<const std::string>& message)>;

  // Calls `take` with the state so far (hello, the whole map, events, playback) before it returns,
  // then with every new message, one call at a time, from any thread, until Leave() has returned.
  // `take` must be fast, because all receivers wait for it. May be called from any thread, but not
  // from `take`.
  virtual int Join(Take take) = 0;
  virtual void Leave(int id) = 0;

  // Executes a viewer's request. Ignored for live cameras. Any thread.
  virtual void Control(StreamControl control) = 0;
};

}  // namespace alidade
