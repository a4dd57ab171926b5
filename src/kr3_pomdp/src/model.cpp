#include "kr3_pomdp/model.hpp"

#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

void SparseRows::append(const std::vector<SparseEntry>& row)
{
  entries_.insert(entries_.end(), row.begin(), row.end());
  starts_.push_back(entries_.size());
}

NameTable::NameTable(const std::string& kind, std::vector<std::string> names)
  : names_(std::move(names))
{
  if (names_.empty())
  {
    throw InvalidArgument("no " + kind + "s, expected at least one");
  }
  index_.reserve(names_.size());
  for (std::size_t i = 0; i < names_.size(); ++i)
  {
    if (names_[i].empty())
    {
      throw InvalidArgument(kind + " " + std::to_string(i) + " has an empty name");
    }
    if (!index_.emplace(names_[i], i).second)
    {
      throw InvalidArgument("two " + kind + "s are called '" + names_[i] + "'");
    }
  }
}

std::optional<std::size_t> NameTable::find(std::string_view name) const
{
  const auto found = index_.find(std::string(name));
  return found == index_.end() ? std::nullopt : std::optional<std::size_t>(found->second);
}

Model::Model(NameTable states, NameTable actions, NameTable observations, Belief initial_belief)
  : states_(std::move(states))
  , actions_(std::move(actions))
  , observations_(std::move(observations))
  , initial_belief_(std::move(initial_belief))
{
}

std::size_t Model::sizeInBytes() const
{
  std::size_t bytes =
      sizeof(Model) +
      (transitions_.numEntries() + observation_rows_.numEntries()) * sizeof(SparseEntry) +
      (transitions_.numRows() + observation_rows_.numRows()) * sizeof(std::size_t) +
      (rewards_.size() + initial_belief_.size()) * sizeof(double);
  for (const NameTable* names : {&states_, &actions_, &observations_})
  {
    for (const std::string& name : names->names())
    {
      bytes += 2 * (sizeof(std::string) + name.size()) + 4 * sizeof(void*);  // list and index
    }
  }
  return bytes;
}

Model Model::withInitialBelief(Belief belief) const
{
  if (belief.size() != numStates())
  {
    throw InvalidArgument("belief over " + std::to_string(belief.size()) + " states, expected " +
                          std::to_string(numStates()));
  }
  Model copy = *this;
  copy.initial_belief_ = std::move(belief);
  return copy;
}

}  // namespace kr3::pomdp
