#include "atom_components.hpp"

#include <algorithm>
#include <cstdlib>

namespace kr3::reasoner
{

AtomComponents::Atom AtomComponents::representative(Atom atom)
{
  while (parents_.size() <= atom)
  {
    parents_.push_back(static_cast<Atom>(parents_.size()));
  }
  while (parents_[atom] != atom)
  {
    parents_[atom] = parents_[parents_[atom]];  // halve the path
    atom = parents_[atom];
  }
  return atom;
}

void AtomComponents::join(const std::vector<Clingo::literal_t>& literals)
{
  for (std::size_t i = 1; i < literals.size(); ++i)
  {
    const Atom first = representative(static_cast<Atom>(std::abs(literals.front())));
    const Atom other = representative(static_cast<Atom>(std::abs(literals[i])));
    parents_[std::max(first, other)] = std::min(first, other);
  }
}

}  // namespace kr3::reasoner
