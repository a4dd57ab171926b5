#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "kr3_pomdp/model.hpp"
#include "kr3_pomdp/policy.hpp"

namespace kr3::pomdp
{

/// The beliefs that a policy comes to, with its action at each: what was met before is not worked
/// out again, up to a bound of memory. What it says never depends on what it remembers.
///
/// Not thread-safe; one for each thread.
class PolicyWalk
{
public:
  struct Place
  {
    std::vector<SparseEntry> belief;
    std::size_t action = 0;

  private:
    friend class PolicyWalk;
    struct Step
    {
      std::size_t observation;
      Place* to;
    };
    std::vector<Step> steps;
    bool kept = false;
  };

  /// @param model, policy  must outlive it and fit each other
  PolicyWalk(const Model& model, const Policy& policy, std::size_t max_bytes);

  /// @return valid until the second call of start() or after() from here
  Place* start(const Belief& belief);
  /// The belief after the action at `from` and this observation, which must be possible.
  /// @return valid until the second call of start() or after() from here
  Place* after(Place* from, std::size_t observation);

private:
  /// Finds or makes the place of `next_`.
  Place* placeOfNext();
  [[nodiscard]] std::size_t actionAtNext();

  const Model& model_;
  const Policy& policy_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::deque<Place> kept_;
  std::unordered_multimap<std::uint64_t, Place*> by_belief_;
  Place passing_[2];  // used in turn once memory is full
  std::size_t turn_ = 0;
  std::vector<SparseEntry> next_;
  std::vector<double> predicted_;  // shape [num_states], 0 between calls
  std::vector<std::uint32_t> touched_;
};

}  // namespace kr3::pomdp
