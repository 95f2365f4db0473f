// Values by id, for marks and tallies of some of the ids ever given: cost follows the entries that
// are in, not the largest id.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace alidade {

// Open addressing with linear probing over places in a dense list of entries, which keeps the order
// in which they came: iterating is deterministic, and clearing keeps the memory for the next time.
template <typename IdType, typename Value>
class IdMap {
 public:
  using Entry = std::pair<IdType, Value>;

  size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const std::vector<Entry>& entries() const { return entries_; }  // in order of entering

  Value* Find(IdType id) {
    const uint32_t place = PlaceOf(id);
    return place == kNone ? nullptr : &entries_[place].second;
  }
  const Value* Find(IdType id) const { return const_cast<IdMap*>(this)->Find(id); }
  bool Contains(IdType id) const { return Find(id) != nullptr; }

  // The entry of `id`, made when there is none; true when it was made. Valid until the next one.
  std::pair<Value*, bool> Enter(IdType id) {
    if (2 * (entries_.size() + 1) > slots_.size()) Grow(2 * slots_.size());
    uint32_t slot = SlotOf(id);
    for (; slots_[slot] != kNone; slot = (slot + 1) & mask()) {
      if (entries_[slots_[slot]].first == id) return {&entries_[slots_[slot]].second, false};
    }
    slots_[slot] = static_cast<uint32_t>(entries_.size());
    entries_.push_back({id, Value{}});
    return {&entries_.back().second, true};
  }
  Value& operator[](IdType id) { return *Enter(id).first; }

  void Clear() {
    entries_.clear();
    std::fill(slots_.begin(), slots_.end(), kNone);
  }
  // Takes out the entries for which gone(id, value), and gives memory back when few are left.
  template <typename Gone>
  void EraseIf(Gone&& gone) {
    std::erase_if(entries_, [&](const Entry& e) { return gone(e.first, e.second); });
    if (4 * entries_.capacity() > 16 * entries_.size()) entries_.shrink_to_fit();
    size_t slots = kFewest;
    while (slots < 2 * (entries_.size() + 1)) slots *= 2;
    Grow(slots);
  }

 private:
  static constexpr uint32_t kNone = 0xffffffffu;
  static constexpr size_t kFewest = 64;

  uint32_t mask() const { return static_cast<uint32_t>(slots_.size()) - 1; }
  uint32_t SlotOf(IdType id) const {  // Fibonacci hashing: neighbours in number spread out
    return (id.value * 2654435769u) >> shift_;
  }
  uint32_t PlaceOf(IdType id) const {
    if (entries_.empty()) return kNone;
    for (uint32_t slot = SlotOf(id); slots_[slot] != kNone; slot = (slot + 1) & mask()) {
      if (entries_[slots_[slot]].first == id) return slots_[slot];
    }
    return kNone;
  }
  void Grow(size_t slots) {  // a power of two, more than there are entries
    slots = std::max(slots, kFewest);
    slots_.assign(slots, kNone);
    shift_ = 32;
    while ((size_t{1} << (32 - shift_)) < slots) --shift_;
    for (size_t i = 0; i < entries_.size(); ++i) {
      uint32_t slot = SlotOf(entries_[i].first);
      while (slots_[slot] != kNone) slot = (slot + 1) & mask();
      slots_[slot] = static_cast<uint32_t>(i);
    }
  }

  std::vector<Entry> entries_;
  std::vector<uint32_t> slots_;  // places in entries_, kNone: free; at least half are
  int shift_ = 32;               // 32 - log2(slots)
};

// Which ids were met.
template <typename IdType>
class IdSet {
 public:
  bool Enter(IdType id) { return met_.Enter(id).second; }  // false when it was in already
  bool Contains(IdType id) const { return met_.Contains(id); }
  void Clear() { met_.Clear(); }

 private:
  struct Nothing {};
  IdMap<IdType, Nothing> met_;
};

}  // namespace alidade
