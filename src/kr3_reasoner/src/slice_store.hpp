#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <vector>

#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

class DomainKnowledge;

/// The slices of a description that were used last, so that what was grounded for one stays
/// grounded while the history grows. Private to the package.
class SliceStore
{
public:
  /// Which fluents, actions, rules and constants of the description a slice keeps: with the
  /// description, all of its content.
  using Key = std::vector<bool>;

  /// The slice of this content, kept or made.
  [[nodiscard]] std::shared_ptr<DomainKnowledge> find(
      const Key& key, const std::function<std::shared_ptr<DomainKnowledge>()>& make);

private:
  struct Entry
  {
    Key key;
    std::shared_ptr<DomainKnowledge> slice;
  };
  static constexpr std::size_t kMost = 16;

  std::list<Entry> entries_;  // the one used last comes first
};

}  // namespace kr3::reasoner
