#include "atom_components.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

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

void AtomComponents::join(const Literals& literals)
{
  std::vector<Literals> rules{literals};
  while (!rules.empty())
  {
    const Literals joined = std::move(rules.back());
    rules.pop_back();
    for (const Clingo::literal_t literal : joined)
    {
      const auto atom = static_cast<Atom>(std::abs(literal));
      const Atom first = representative(static_cast<Atom>(std::abs(joined.front())));
      const Atom other = representative(atom);
      parents_[std::max(first, other)] = std::min(first, other);
      if (isUsed(atom))
      {
        continue;
      }
      used_.resize(std::max<std::size_t>(used_.size(), atom + 1), false);
      used_[atom] = true;
      if (const auto found = definitions_.find(atom); found != definitions_.end())
      {
        for (Literals& body : found->second)
        {
          body.push_back(static_cast<Clingo::literal_t>(atom));
          rules.push_back(std::move(body));
        }
        definitions_.erase(found);
      }
    }
  }
}

void AtomComponents::define(Atom head, Literals body)
{
  if (isUsed(head))
  {
    body.push_back(static_cast<Clingo::literal_t>(head));
    join(body);
  }
  else
  {
    definitions_[head].push_back(std::move(body));
  }
}

}  // namespace kr3::reasoner
