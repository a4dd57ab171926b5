#include "rule.hpp"

#include <algorithm>
#include <iterator>

namespace kr3::refinement
{

int Vocabulary::intern(const std::string& name)
{
  const auto [entry, is_new] = index_.try_emplace(name, static_cast<int>(names_.size()));
  if (is_new)
  {
    names_.push_back(name);
  }
  return entry->second;
}

int Vocabulary::find(const std::string& name) const
{
  const auto entry = index_.find(name);
  return entry == index_.end() ? kNone : entry->second;
}

ConstantSet::ConstantSet(std::vector<int> elements) : elements_(std::move(elements))
{
  for (const int element : elements_)
  {
    const auto index = static_cast<std::size_t>(element);
    member_.resize(std::max(member_.size(), index + 1), 0);
    member_[index] = 1;
  }
}

ConstantSet ConstantSet::intersection(const ConstantSet& other) const
{
  std::vector<int> common;
  for (const int element : elements_)
  {
    if (other.contains(element))
    {
      common.push_back(element);
    }
  }
  return ConstantSet(std::move(common));
}

ConstantSet ConstantSet::without(const ConstantSet& other) const
{
  std::vector<int> rest;
  std::copy_if(elements_.begin(), elements_.end(), std::back_inserter(rest),
               [&other](int element) { return !other.contains(element); });
  return ConstantSet(std::move(rest));
}

}  // namespace kr3::refinement
