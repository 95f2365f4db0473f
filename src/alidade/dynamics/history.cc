#include "alidade/dynamics/history.h"

namespace alidade {

void History::Add(std::shared_ptr<const PastView> view) {
  recent_.push_front(std::move(view));
  if (recent_.size() <= static_cast<size_t>(settings_.recent)) return;
  const std::shared_ptr<const PastView> last = recent_.back();
  recent_.pop_back();
  if (!last || (!older_.empty() && last->number - older_.front()->number < settings_.step)) return;
  older_.push_front(last);
  if (older_.size() > most_older()) older_.pop_back();
}

void History::Clear() {
  for (auto& view : recent_) view = nullptr;  // keep the count of frames, which tracks refer to
  older_.clear();
}

const PastView* History::Before(int ago) const {
  return ago >= 1 && static_cast<size_t>(ago) <= recent_.size() ? recent_[ago - 1].get() : nullptr;
}

const PastView* History::Older(size_t index) const {
  return index < older_.size() ? older_[index].get() : nullptr;
}

}  // namespace alidade
