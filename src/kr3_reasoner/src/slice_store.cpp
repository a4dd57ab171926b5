#include "slice_store.hpp"

#include <algorithm>

#include "domain_knowledge.hpp"

namespace kr3::reasoner
{

std::shared_ptr<DomainKnowledge> SliceStore::find(
    const Key& key, const std::function<std::shared_ptr<DomainKnowledge>()>& make)
{
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& entry) { return entry.key == key; });
  if (found != entries_.end())
  {
    entries_.splice(entries_.begin(), entries_, found);
  }
  else
  {
    entries_.push_front({key, make()});
    if (entries_.size() > kMost)
    {
      entries_.pop_back();
    }
  }
  return entries_.front().slice;
}

}  // namespace kr3::reasoner
