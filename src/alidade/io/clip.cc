#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "alidade/base/error.h"
#include "alidade/io/wrappers.h"

namespace alidade {
namespace {

class ClippedSource : public FrameSource {
 public:
  // The next frame of `source` is frame `first`; or, when that frame was already read, it is passed
  // as `pending`. `count` -1: all remaining frames.
  ClippedSource(std::unique_ptr<FrameSource> source, int first, int count,
                std::optional<SourceFrame> pending)
      : source_(std::move(source)),
        info_(source_->Info()),
        first_(first),
        count_(count),
        pending_(std::move(pending)) {
    if (info_.frames >= 0) info_.frames -= first;
    if (count >= 0) info_.frames = info_.frames < 0 ? -1 : std::min(info_.frames, count);
  }

  const SourceInfo& Info() const override { return info_; }

  void Stop() override { source_->Stop(); }
  bool Seek(int frames) override {
    if (!source_->Seek(first_ + frames)) return false;
    done_ = frames;
    pending_.reset();
    return true;
  }

  std::optional<SourceFrame> Next() override {
    if (count_ >= 0 && done_ >= count_) return std::nullopt;
    ++done_;
    if (pending_) return std::exchange(pending_, std::nullopt);
    return source_->Next();
  }

 private:
  std::unique_ptr<FrameSource> source_;
  SourceInfo info_;
  int first_, count_, done_ = 0;
  std::optional<SourceFrame> pending_;
};

}  // namespace

std::unique_ptr<FrameSource> Clip(std::unique_ptr<FrameSource> source, int first, int last) {
  if (first < 0) ThrowUsage("--first must not be negative");
  if (last < -1 || (last >= 0 && last < first)) ThrowUsage("--last must not come before --first");
  if (first == 0 && last == -1) return source;
  const int frames = source->Info().frames;
  if (frames >= 0 && first >= frames) {
    ThrowInput("--first " + std::to_string(first) + " lies past the end: the recording has " +
               std::to_string(frames) + " frames (0 to " + std::to_string(frames - 1) + ")");
  }
  int skipped = source->Seek(first) ? first : 0;
  while (skipped < first && source->Next()) ++skipped;
  std::optional<SourceFrame> pending;
  if (frames < 0) {  // the length is unknown: read frame `first` to find out whether it exists
    if (skipped == first) pending = source->Next();
    if (!pending)
      ThrowInput("--first " + std::to_string(first) + " lies past the end of the recording");
  }
  // INT_MAX means the end as well, and INT_MAX + 1 would overflow.
  const bool to_the_end = last < 0 || last == std::numeric_limits<int>::max();
  return std::make_unique<ClippedSource>(std::move(source), first,
                                         to_the_end ? -1 : last - first + 1, std::move(pending));
}

}  // namespace alidade
