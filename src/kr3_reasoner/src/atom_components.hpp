#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include <clingo.hh>

namespace kr3::reasoner
{

/// Which atoms of a program hang together: two are in one component when a rule has both, perhaps
/// through others. The answer sets of the program are the combinations of those of its components.
///
/// A rule that says when an atom is true joins nothing before the atom is used: by a rule that is
/// no such definition, or by one of an atom that is used. What nothing depends on restricts
/// nothing, in programs where no atom rests on its own negation (definition_check.hpp sees to it).
class AtomComponents
{
public:
  using Atom = std::uint32_t;
  using Literals = std::vector<Clingo::literal_t>;

  /// The literals stand in one rule. They are used from now on.
  void join(const Literals& literals);

  /// `head :- body`, not the only such rule perhaps.
  void define(Atom head, Literals body);

  /// Something that is no rule depends on the atom.
  void use(Atom atom) { join({static_cast<Clingo::literal_t>(atom)}); }
  [[nodiscard]] bool isUsed(Atom atom) const { return atom < used_.size() && used_[atom]; }

  /// One atom that stands for the component of `atom`. One that is not used stands for itself: what
  /// defines it joins it later.
  [[nodiscard]] Atom representative(Atom atom);

private:
  std::vector<Atom> parents_;
  std::vector<bool> used_;
  std::unordered_map<Atom, std::vector<Literals>> definitions_;  // of atoms that are not used
};

}  // namespace kr3::reasoner
