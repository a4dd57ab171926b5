#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kr3_pomdp/policy.hpp"
#include "observed_model.hpp"

namespace kr3::pomdp
{

/// A belief in one class, as its non-zero entries (local indices, ascending).
struct ClassBelief
{
  std::uint32_t state_class;
  std::vector<SparseEntry> entries;
};

/// Bounds of the value of beliefs, fast, for planning online: from below a policy, from above the
/// fast informed bound.
class ClassBounds
{
public:
  /// @param model   outlives this object
  /// @param policy  null: the blind policies, each one action for ever
  ClassBounds(const Model& model, const Policy* policy);

  [[nodiscard]] const std::vector<StateClass>& classes() const { return observed_.classes(); }

  /// A belief over the model's states (ascending, none twice) within one class; nothing when no
  /// class holds all of it.
  [[nodiscard]] std::optional<ClassBelief> located(const std::vector<SparseEntry>& belief) const;

  struct Lower
  {
    std::size_t action;
    double value;
  };
  /// @param sums  scratch, as in the next
  [[nodiscard]] Lower lowerAt(const ClassBelief& belief, std::vector<double>& sums) const;
  [[nodiscard]] double upperAt(const ClassBelief& belief, std::vector<double>& sums) const;

private:
  /// Vectors over the states of a class.
  struct Vectors
  {
    std::vector<std::uint32_t> actions;  // shape [vectors]
    std::vector<double> values;          // row-major, shape [states, vectors]
  };
  [[nodiscard]] static Lower greatestAt(const Vectors& vectors, const ClassBelief& belief,
                                        std::vector<double>& sums);
  [[nodiscard]] static Vectors byState(const std::vector<std::vector<double>>& vectors,
                                       std::vector<std::uint32_t> actions, std::size_t num_states);
  [[nodiscard]] static Vectors ofPolicy(const std::vector<AlphaVector>& alpha_vectors,
                                        const std::vector<std::uint32_t>& states);
  [[nodiscard]] std::optional<ClassBelief> within(std::uint32_t c,
                                                  const std::vector<SparseEntry>& belief) const;

  ObservedModel observed_;
  std::vector<Vectors> lower_;  // one for each class, as the next
  std::vector<Vectors> upper_;
  std::vector<std::uint32_t> class_of_;  // shape [num_states]; classes of starts only left out
};

}  // namespace kr3::pomdp
