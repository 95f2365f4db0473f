// Hash map keyed by id. Memory and time grow with the number of entries, not with the largest id
// ever issued.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace alidade {

// Open addressing with linear probing; slots index a dense vector of entries that keeps insertion
// order. Iteration is therefore deterministic, and Clear() keeps the allocated memory for reuse.
template <typename IdType, typename Value>
class IdMap {
 public:
  using Entry = std::pair<IdType, Value>;

  size_t size() const { return entries_.size(); }
  bool empty() const { return entries_.empty(); }
  const std::vector<Entry>& entries() const { return entries_; }  // in insertion order

  Value* Find(IdType id) {
    const uint32_t place = PlaceOf(id);
    return place == kNone ? nullptr : &entries_[place].second;
  }
  const Value* Find(IdType id) const { return const_cast<IdMap*>(this)->Find(id); }
  bool Contains(IdType id) const { return Find(id) != nullptr; }

  // Finds or inserts the entry of `id`. The bool is true if it was inserted. The pointer is valid
  // until the next insertion.
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
  // Removes the entries for which gone(id, value) is true and releases memory if few remain.
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
  uint32_t SlotOf(IdType id) const {  // Fibonacci hashing spreads consecutive ids
    return (id.value * 2654435769u) >> shift_;
  }
  uint32_t PlaceOf(IdType id) const {
    if (entries_.empty()) return kNone;
    for (uint32_t slot = SlotOf(id); slots_[slot] != kNone; slot = (slot + 1) & mask()) {
      if (entries_[slots_[slot]].first == id) return slots_[slot];
    }
    return kNone;
  }
  void Grow(size_t slots) {  // `slots`: a power of two larger than the number of entries
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
  std::vector<uint32_t> slots_;  // indices into entries_, or kNone if free; at least half are free
  int shift_ = 32;               // 32 - log2(slots)
};

// Set of ids.
template <typename IdType>
class IdSet {
 public:
  bool Enter(IdType id) { return met_.Enter(id).second; }  // false if it was already present
  bool Contains(IdType id) const { return met_.Contains(id); }
  void Clear() { met_.Clear(); }

 private:
  struct Nothing {};
  IdMap<IdType, Nothing> met_;
};

}  // namespace alidade
