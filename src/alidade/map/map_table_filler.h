// Builds the tables of a MapState from objects that come with their ids. For map_decode.cc only.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "alidade/map/map_store.h"

namespace alidade {

// Memory grows with the objects that are there, hardly with `next`: a file may say anything.
template <typename Object>
class MapTableFiller {
 public:
  explicit MapTableFiller(uint32_t next)
      : next_(next), pages_((static_cast<size_t>(next) + kSize - 1) / kSize) {}

  // A new object of that id; null when there is one already, or the id was never given.
  Object* Add(uint32_t id) {
    if (id >= next_) return nullptr;
    auto& page = pages_[id / kSize];
    if (!page) page = std::make_unique<Page>();
    auto& object = (*page)[id % kSize];
    if (object) return nullptr;
    object = std::make_shared<Object>();
    object->id = {id};
    return object.get();
  }

  Object* Find(uint32_t id) {
    if (id >= next_ || !pages_[id / kSize]) return nullptr;
    return (*pages_[id / kSize])[id % kSize].get();
  }

  MapTable<Object> Finish(int alive) const {
    MapTable<Object> table;
    table.next = next_;
    table.alive = alive;
    table.pages.reserve(pages_.size());
    const auto nothing = std::make_shared<const MapPage<Object>>();  // for all empty pages
    for (const auto& page : pages_) {
      if (!page) {
        table.pages.push_back(nothing);
        continue;
      }
      auto filled = std::make_shared<MapPage<Object>>();
      for (uint32_t i = 0; i < kSize; ++i) filled->slots[i] = (*page)[i];
      table.pages.push_back(std::move(filled));
    }
    return table;
  }

 private:
  static constexpr uint32_t kSize = MapPage<Object>::kSize;
  using Page = std::array<std::shared_ptr<Object>, kSize>;
  uint32_t next_;
  std::vector<std::unique_ptr<Page>> pages_;
};

}  // namespace alidade
