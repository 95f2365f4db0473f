// Table of objects by id: a persistent tree with 64 branches per node whose nodes are shared
// between versions of the map. A change copies the nodes on the path to the object; empty nodes are
// freed. Memory and the cost of a change depend on the number of objects, not on the largest id.
// (Path copying: Driscoll, Sarnak, Sleator & Tarjan 1989.)
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "alidade/base/api.h"

namespace ALIDADE_API alidade {

// Type-erased tree. Reading is thread-safe; a copy shares all nodes.
class IdTree {
 public:
  const void* At(uint32_t id) const {
    if (!root_ || (static_cast<uint64_t>(id) >> (kBits * levels_)) != 0) return nullptr;
    const Node* node = root_.get();
    for (int level = levels_ - 1; level > 0; --level) {
      node = static_cast<const Node*>(node->slots[(id >> (kBits * level)) & kMask].get());
      if (!node) return nullptr;
    }
    return node->slots[id & kMask].get();
  }
  int size() const { return size_; }

  // Sets or (null) erases the object. Nodes not created by `version` are copied first; those
  // created by it are exclusive to the caller until the tree is published.
  void Set(uint32_t id, std::shared_ptr<const void> object, uint64_t version);

  // Calls visit(object) in order of ids; ForEachFromLast() in reverse order until visit returns
  // false.
  template <typename Visit>
  void ForEach(Visit&& visit) const {
    if (root_) Walk(*root_, levels_ - 1, visit);
  }
  template <typename Visit>
  void ForEachFromLast(Visit&& visit) const {
    if (root_) WalkBack(*root_, levels_ - 1, visit);
  }

  // Calls visit(object in `before`, object here) in order of ids for all ids where they differ
  // (null: absent). Shared nodes are skipped, so the cost is proportional to the number of changes.
  template <typename Visit>
  void ForEachChange(const IdTree& before, Visit&& visit) const {
    WalkChanges({before.root_.get(), before.levels_}, {root_.get(), levels_},
                std::max(levels_, before.levels_), visit);
  }

  int CountNodes() const;                          // for tests
  int CountNodesNotIn(const IdTree& other) const;  // nodes not shared with `other`

 private:
  static constexpr int kBits = 6, kSlots = 1 << kBits;
  static constexpr uint32_t kMask = kSlots - 1;
  struct Node {
    // Child nodes; on the lowest level objects.
    std::array<std::shared_ptr<const void>, kSlots> slots;
    int used = 0;  // number of nonempty slots
    uint64_t version = 0;
  };

  struct Subtree {
    const Node* node = nullptr;
    int levels = 0;
    // The part in slot `i` of a tree of `high` levels; a lower tree is entirely in slot 0.
    Subtree Part(int i, int high) const {
      if (levels < high) return i == 0 ? *this : Subtree{};
      if (!node) return {};
      return {static_cast<const Node*>(node->slots[static_cast<size_t>(i)].get()), levels - 1};
    }
    const void* Object(int i) const {
      return node ? node->slots[static_cast<size_t>(i)].get() : nullptr;
    }
  };

  static bool SetBelow(std::shared_ptr<const void>& slot, int level, uint32_t id,
                       std::shared_ptr<const void> object, uint64_t version);
  static void Gather(const Node& node, int level, std::vector<const Node*>& nodes);
  template <typename Visit>
  static void Walk(const Node& node, int level, Visit& visit) {
    for (const auto& slot : node.slots) {
      if (!slot) continue;
      if (level == 0) {
        visit(slot.get());
      } else {
        Walk(*static_cast<const Node*>(slot.get()), level - 1, visit);
      }
    }
  }
  template <typename Visit>
  static bool WalkBack(const Node& node, int level, Visit& visit) {
    for (int i = kSlots; i-- > 0;) {
      const void* slot = node.slots[i].get();
      if (!slot) continue;
      const bool on =
          level == 0 ? visit(slot) : WalkBack(*static_cast<const Node*>(slot), level - 1, visit);
      if (!on) return false;
    }
    return true;
  }

  template <typename Visit>
  static void WalkChanges(Subtree before, Subtree now, int levels, Visit& visit) {
    if (before.node == now.node && (!now.node || before.levels == now.levels)) return;
    for (int i = 0; i < kSlots; ++i) {
      if (levels > 1) {
        WalkChanges(before.Part(i, levels), now.Part(i, levels), levels - 1, visit);
      } else if (before.Object(i) != now.Object(i)) {
        visit(before.Object(i), now.Object(i));
      }
    }
  }

  std::shared_ptr<const Node> root_;
  int levels_ = 1;
  int size_ = 0;
};

// The same for one object type.
template <typename Object>
class IdTable {
 public:
  const Object* At(uint32_t id) const { return static_cast<const Object*>(tree_.At(id)); }
  int size() const { return tree_.size(); }
  void Set(uint32_t id, std::shared_ptr<const Object> object, uint64_t version) {
    tree_.Set(id, std::move(object), version);
  }
  void Erase(uint32_t id, uint64_t version) { tree_.Set(id, nullptr, version); }
  template <typename Visit>
  void ForEach(Visit&& visit) const {
    tree_.ForEach([&](const void* object) { visit(*static_cast<const Object*>(object)); });
  }
  template <typename Visit>
  void ForEachFromLast(Visit&& visit) const {
    tree_.ForEachFromLast(
        [&](const void* object) { return visit(*static_cast<const Object*>(object)); });
  }
  // visit(const Object* before, const Object* now): see IdTree.
  template <typename Visit>
  void ForEachChange(const IdTable& before, Visit&& visit) const {
    tree_.ForEachChange(before.tree_, [&](const void* then, const void* now) {
      visit(static_cast<const Object*>(then), static_cast<const Object*>(now));
    });
  }
  const IdTree& tree() const { return tree_; }

 private:
  IdTree tree_;
};

}  // namespace alidade
