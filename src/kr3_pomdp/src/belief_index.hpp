#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kr3::pomdp
{

using NodeId = std::uint32_t;

/// Finds nodes by the hash of their belief (open addressing, linear probing).
class BeliefIndex
{
public:
  /// The first node of that hash for which `matches` is true, or kNotFound.
  template <typename Matches>
  [[nodiscard]] NodeId find(std::uint64_t hash, const Matches& matches) const
  {
    if (slots_.empty())
    {
      return kNotFound;
    }
    for (std::size_t i = hash & (slots_.size() - 1); slots_[i].node != kNotFound;
         i = (i + 1) & (slots_.size() - 1))
    {
      if (slots_[i].tag == tagOf(hash) && matches(slots_[i].node))
      {
        return slots_[i].node;
      }
    }
    return kNotFound;
  }
  /// @param hash_of  gives the hash of a node that is in the index
  template <typename HashOf>
  void insert(std::uint64_t hash, NodeId node, const HashOf& hash_of)
  {
    if (2 * (size_ + 1) > slots_.size())
    {
      std::vector<Slot> old(slots_.empty() ? kLeast : 2 * slots_.size());
      old.swap(slots_);
      for (const Slot& slot : old)
      {
        if (slot.node != kNotFound)
        {
          place(hash_of(slot.node), slot.node);
        }
      }
    }
    place(hash, node);
    ++size_;
  }
  [[nodiscard]] std::size_t sizeInBytes() const { return slots_.capacity() * sizeof(Slot); }

  static constexpr NodeId kNotFound = 0xffffffff;

private:
  struct Slot
  {
    NodeId node = kNotFound;
    std::uint32_t tag = 0;
  };
  static constexpr std::size_t kLeast = 1024;
  static std::uint32_t tagOf(std::uint64_t hash) { return static_cast<std::uint32_t>(hash >> 32U); }
  void place(std::uint64_t hash, NodeId node)
  {
    std::size_t i = hash & (slots_.size() - 1);
    while (slots_[i].node != kNotFound)
    {
      i = (i + 1) & (slots_.size() - 1);
    }
    slots_[i] = {node, tagOf(hash)};
  }

  std::vector<Slot> slots_;  // a power of two
  std::size_t size_ = 0;
};

}  // namespace kr3::pomdp
