// Answers pictures that are sent by POST with their poses in a map (docs/guides/localize.md).
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "alidade/localize/localizer.h"
#include "alidade/serve/post_host.h"

namespace alidade {

struct LocalizeHostSettings {
  int threads = 0;  // pictures at a time; 0: one per core
  // Pictures that wait, each with its bytes. A client may have to wait for as many divided by the
  // pictures per second.
  size_t most_waiting = 64;
};

// Thread-safe. Pictures are processed in the order in which they came.
class LocalizeHost : public PostHost {
 public:
  static constexpr size_t kMostBytes = size_t{32} << 20;  // of a picture: 100 megapixels as JPEG

  // Throws Error (input) if there is nothing to find in the map. `name`: for users.
  LocalizeHost(SavedMap map, std::string name, const LocalizeHostSettings& settings = {});
  ~LocalizeHost() override;  // pictures that wait get no answer
  LocalizeHost(const LocalizeHost&) = delete;
  LocalizeHost& operator=(const LocalizeHost&) = delete;

  std::string_view path() const override { return "/localize"; }
  size_t most_bytes() const override { return kMostBytes; }
  bool Take(PostRequest request, PostReply reply) override;

  // The answer to one picture. Any thread.
  PostAnswer Answer(const PostRequest& request) const;
  std::string Info() const;  // JSON: what the map is
  const Localizer& localizer() const { return localizer_; }

 private:
  void Work();

  Localizer localizer_;
  std::string name_;
  LocalizeHostSettings settings_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::pair<PostRequest, PostReply>> waiting_;  // guarded by mutex_
  bool end_ = false;                                       // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace alidade
