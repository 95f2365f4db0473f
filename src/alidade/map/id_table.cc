#include "alidade/map/id_table.h"

#include <algorithm>
#include <vector>

namespace alidade {

void IdTree::Set(uint32_t id, std::shared_ptr<const void> object, uint64_t version) {
  const bool there = At(id) != nullptr;
  if (!there && !object) return;
  size_ += (object != nullptr) - there;
  while ((static_cast<uint64_t>(id) >> (kBits * levels_)) != 0) {  // add a level on top
    if (root_) {
      auto top = std::make_shared<Node>();
      top->version = version;
      top->slots[0] = std::move(root_);
      top->used = 1;
      root_ = std::move(top);
    }
    ++levels_;
  }
  std::shared_ptr<const void> root = std::move(root_);
  SetBelow(root, levels_ - 1, id, std::move(object), version);
  root_ = std::static_pointer_cast<const Node>(std::move(root));
}

// Returns true if the slot is empty afterwards.
bool IdTree::SetBelow(std::shared_ptr<const void>& slot, int level, uint32_t id,
                      std::shared_ptr<const void> object, uint64_t version) {
  auto* node = const_cast<Node*>(static_cast<const Node*>(slot.get()));
  if (!node || node->version != version) {
    auto copy = node ? std::make_shared<Node>(*node) : std::make_shared<Node>();
    copy->version = version;
    node = copy.get();
    slot = std::move(copy);
  }
  auto& below = node->slots[(id >> (kBits * level)) & kMask];
  const bool before = below != nullptr;
  if (level == 0) {
    below = std::move(object);
  } else {
    SetBelow(below, level - 1, id, std::move(object), version);
  }
  node->used += (below != nullptr) - before;
  if (node->used == 0) slot = nullptr;
  return !slot;
}

void IdTree::Gather(const Node& node, int level, std::vector<const Node*>& nodes) {
  nodes.push_back(&node);
  if (level == 0) return;
  for (const auto& slot : node.slots) {
    if (slot) Gather(*static_cast<const Node*>(slot.get()), level - 1, nodes);
  }
}

int IdTree::CountNodes() const {
  std::vector<const Node*> nodes;
  if (root_) Gather(*root_, levels_ - 1, nodes);
  return static_cast<int>(nodes.size());
}

int IdTree::CountNodesNotIn(const IdTree& other) const {
  std::vector<const Node*> mine, others, own;
  if (root_) Gather(*root_, levels_ - 1, mine);
  if (other.root_) Gather(*other.root_, other.levels_ - 1, others);
  std::sort(mine.begin(), mine.end());
  std::sort(others.begin(), others.end());
  std::set_difference(mine.begin(), mine.end(), others.begin(), others.end(),
                      std::back_inserter(own));
  return static_cast<int>(own.size());
}

}  // namespace alidade
