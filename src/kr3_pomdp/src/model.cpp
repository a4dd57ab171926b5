#include "kr3_pomdp/model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::pomdp
{

void SparseRows::append(const std::vector<SparseEntry>& row)
{
  entries_.insert(entries_.end(), row.begin(), row.end());
  starts_.push_back(entries_.size());
}

std::size_t SharedRows::sizeInBytes() const
{
  return distinct_.numEntries() * sizeof(SparseEntry) +
         (distinct_.numRows() + 1) * sizeof(std::size_t) + numbers_.size() * sizeof(std::uint32_t);
}

namespace
{

constexpr std::uint64_t kTagBits = 0xffffffff00000000ULL;
constexpr std::uint64_t kLine = 8;  // slots in a line of the cache

/// Equal for rows of one form that lead to neighbours.
std::uint64_t hashOf(const SparseEntry* first, const SparseEntry* last)
{
  std::uint64_t hash = 0;
  for (const SparseEntry* entry = first; entry != last; ++entry)
  {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &entry->probability, sizeof(bits));
    hash = (hash ^ (bits + (entry->index - first->index))) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 29;
  }
  hash = (hash ^ (first == last ? 0 : first->index / kLine)) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 29);
}

/// Where the search for a row begins. Neighbours come one after the other, and lie so too.
std::uint64_t homeOf(const SparseEntry* first, const SparseEntry* last, std::uint64_t hash)
{
  return hash * kLine + (first == last ? 0 : first->index % kLine);
}

}  // namespace

std::size_t SharedRowsBuilder::slotOf(const std::vector<SparseEntry>& row, std::uint64_t hash) const
{
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t slot = homeOf(row.data(), row.data() + row.size(), hash) & mask;;
       slot = (slot + 1) & mask)
  {
    if (slots_[slot] == 0)
    {
      return slot;
    }
    if ((slots_[slot] & kTagBits) == (hash & kTagBits))
    {
      const SparseRow other = rows_.distinct_.row((slots_[slot] & ~kTagBits) - 1);
      if (std::equal(row.begin(), row.end(), other.begin(), other.end(),
                     [](const SparseEntry& p, const SparseEntry& q) {
        return p.index == q.index && p.probability == q.probability;
          }))
      {
        return slot;
      }
    }
  }
}

void SharedRowsBuilder::grow()
{
  slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), 0);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t i = 0; i < rows_.distinct_.numRows(); ++i)
  {
    const SparseRow row = rows_.distinct_.row(i);
    const std::uint64_t hash = hashOf(row.begin(), row.end());
    std::size_t slot = homeOf(row.begin(), row.end(), hash) & mask;
    while (slots_[slot] != 0)
    {
      slot = (slot + 1) & mask;
    }
    slots_[slot] = (hash & kTagBits) | (i + 1);
  }
}

void SharedRowsBuilder::append(const std::vector<SparseEntry>& row)
{
  if (2 * (rows_.distinct_.numRows() + 1) > slots_.size())
  {
    grow();
  }
  const std::uint64_t hash = hashOf(row.data(), row.data() + row.size());
  const std::size_t slot = slotOf(row, hash);
  if (slots_[slot] == 0)
  {
    rows_.distinct_.append(row);
    slots_[slot] = (hash & kTagBits) | rows_.distinct_.numRows();
  }
  rows_.numbers_.push_back(static_cast<std::uint32_t>((slots_[slot] & ~kTagBits) - 1));
}

SharedRows SharedRowsBuilder::take()
{
  slots_.clear();
  return std::exchange(rows_, {});
}

NameTable::NameTable(const std::string& kind, std::vector<std::string> names)
  : names_(std::move(names)), by_name_(names_.size())
{
  if (names_.empty())
  {
    throw InvalidArgument("no " + kind + "s, expected at least one");
  }
  std::iota(by_name_.begin(), by_name_.end(), 0U);
  std::sort(by_name_.begin(), by_name_.end(),
            [this](std::uint32_t i, std::uint32_t j) { return names_[i] < names_[j]; });
  for (std::size_t i = 0; i < names_.size(); ++i)
  {
    if (names_[i].empty())
    {
      throw InvalidArgument(kind + " " + std::to_string(i) + " has an empty name");
    }
    if (i > 0 && names_[by_name_[i - 1]] == names_[by_name_[i]])
    {
      throw InvalidArgument("two " + kind + "s are called '" + names_[by_name_[i]] + "'");
    }
  }
}

std::optional<std::size_t> NameTable::find(std::string_view name) const
{
  const auto found =
      std::lower_bound(by_name_.begin(), by_name_.end(), name,
                       [this](std::uint32_t i, std::string_view n) { return names_[i] < n; });
  return found == by_name_.end() || names_[*found] != name ? std::nullopt
                                                           : std::optional<std::size_t>(*found);
}

namespace
{

constexpr double kSumTolerance = 1e-9;

void checkShape(const char* what, std::size_t found, std::size_t expected)
{
  if (found != expected)
  {
    throw InvalidArgument(std::string(what) + " of size " + std::to_string(found) + ", expected " +
                          std::to_string(expected));
  }
}

/// @param describe  names a row
template <typename Describe>
void checkRows(const SharedRows& rows, std::size_t columns, const Describe& describe)
{
  for (std::size_t i = 0; i < rows.numRows(); ++i)
  {
    double sum = 0.0;
    bool valid = true;
    for (const SparseEntry& entry : rows.row(i))
    {
      sum += entry.probability;
      valid = valid && entry.index < columns && entry.probability >= 0.0;
    }
    if (!valid || !(std::abs(sum - 1.0) <= kSumTolerance))
    {
      throw InvalidArgument(describe(i) + " sums to " + std::to_string(sum) +
                            (valid ? "" : " and has an entry out of range") + ", expected 1");
    }
  }
}

}  // namespace

Model::Model(ModelParts parts)
  : states_("state", std::move(parts.states))
  , actions_("action", std::move(parts.actions))
  , observations_("observation", std::move(parts.observations))
  , discount_(parts.discount)
  , initial_belief_(std::move(parts.initial_belief))
  , initial_labels_(std::move(parts.initial_labels))
  , transitions_(std::move(parts.transitions))
  , observation_rows_(std::move(parts.observation_rows))
  , rewards_(std::move(parts.rewards))
{
  const std::size_t num_rows = numActions() * numStates();
  checkShape("an initial belief", initial_belief_.size(), numStates());
  checkShape("rewards", rewards_.size(), num_rows);
  checkShape("T", transitions_.numRows(), num_rows);
  if (!initial_labels_.empty())
  {
    checkShape("initial labels", initial_labels_.size(), numStates());
  }
  if (!(discount_ > 0.0 && discount_ <= 1.0))
  {
    throw InvalidArgument("discount " + std::to_string(discount_) + ", expected it in (0, 1]");
  }
  checkRows(transitions_, numStates(), [this](std::size_t i) {
    return "T(. | state '" + stateName(i % numStates()) + "', action '" +
           actionName(i / numStates()) + "')";
  });
  checkObservations();
  for (std::size_t i = 0; i < rewards_.size(); ++i)
  {
    if (!std::isfinite(rewards_[i]))
    {
      throw InvalidArgument("R(action '" + actionName(i / numStates()) + "', state '" +
                            stateName(i % numStates()) + "') is not finite");
    }
  }
}

void Model::checkObservations() const
{
  checkShape("O", observation_rows_.numRows(), numActions() * numStates());
  checkRows(observation_rows_, numObservations(), [this](std::size_t i) {
    return "O(. | action '" + actionName(i / numStates()) + "', next state '" +
           stateName(i % numStates()) + "')";
  });
}

std::vector<InitialOutcome> Model::initialOutcomes() const
{
  if (initial_labels_.empty())
  {
    return {{1.0, initial_belief_}};
  }
  std::map<std::uint32_t, std::vector<double>> by_label;
  for (std::size_t s = 0; s < numStates(); ++s)
  {
    if (initial_belief_[s] > 0.0)
    {
      std::vector<double>& belief = by_label[initial_labels_[s]];
      belief.resize(numStates(), 0.0);
      belief[s] = initial_belief_[s];
    }
  }
  std::vector<InitialOutcome> outcomes;
  for (auto& [label, belief] : by_label)
  {
    const double probability = std::accumulate(belief.begin(), belief.end(), 0.0);
    for (double& p : belief)
    {
      p /= probability;
    }
    outcomes.push_back({probability, Belief(std::move(belief))});
  }
  return outcomes;
}

std::size_t Model::sizeInBytes() const
{
  std::size_t bytes = sizeof(Model) + transitions_.sizeInBytes() + observation_rows_.sizeInBytes() +
                      (rewards_.size() + initial_belief_.size()) * sizeof(double) +
                      initial_labels_.size() * sizeof(std::uint32_t);
  for (const NameTable* names : {&states_, &actions_, &observations_})
  {
    for (const std::string& name : names->names())
    {
      bytes += sizeof(std::string) + sizeof(std::uint32_t) + name.size();
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
  copy.initial_labels_.clear();
  return copy;
}

Model Model::withObservations(std::vector<std::string> names, SharedRows rows) const
{
  Model copy = *this;
  copy.observations_ = NameTable("observation", std::move(names));
  copy.observation_rows_ = std::move(rows);
  copy.checkObservations();
  return copy;
}

}  // namespace kr3::pomdp
