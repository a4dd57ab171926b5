#pragma once

#include <cstdint>
#include <vector>

#include <clingo.hh>

namespace kr3::reasoner
{

/// Which atoms of a program hang together: two are in one component when a rule has both, perhaps
/// through others. The answer sets of the program are the combinations of those of its components.
class AtomComponents
{
public:
  using Atom = std::uint32_t;

  /// The literals stand in one rule.
  void join(const std::vector<Clingo::literal_t>& literals);

  /// One atom that stands for the component of `atom`.
  [[nodiscard]] Atom representative(Atom atom);

private:
  std::vector<Atom> parents_;
};

}  // namespace kr3::reasoner
