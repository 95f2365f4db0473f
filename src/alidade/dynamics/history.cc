#include "alidade/dynamics/history.h"

namespace alidade {
namespace {

constexpr size_t kRecent = 32;  // frames
constexpr int kStep = 10;       // frames from one older view to the next
constexpr size_t kOlder = 9;

}  // namespace

void History::Add(std::shared_ptr<const PastView> view) {
  recent_.push_front(std::move(view));
  if (recent_.size() <= kRecent) return;
  const std::shared_ptr<const PastView> last = recent_.back();
  recent_.pop_back();
  if (!last || (!older_.empty() && last->number - older_.front()->number < kStep)) return;
  older_.push_front(last);
  if (older_.size() > kOlder) older_.pop_back();
}

void History::Clear() {
  for (auto& view : recent_) view = nullptr;  // tracks count frames all the same
  older_.clear();
}

const PastView* History::Before(int ago) const {
  return ago >= 1 && static_cast<size_t>(ago) <= recent_.size() ? recent_[ago - 1].get() : nullptr;
}

const PastView* History::Older(size_t index) const {
  return index < older_.size() ? older_[index].get() : nullptr;
}

}  // namespace alidade
