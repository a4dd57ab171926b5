#include <algorithm>

#include <kr3_common/error.hpp>

#include "oracle.hpp"

namespace kr3::reasoner::oracle
{

namespace
{

constexpr std::size_t kMaxHeads = 9;

void closeUnderConstraints(Knowledge& known, const GroundDomain& domain)
{
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const GroundConstraint& constraint : domain.constraints)
    {
      changed =
          (constraint.head && known.has(constraint.body) && known.add(*constraint.head)) || changed;
    }
  }
}

Knowledge closed(const GroundDomain& domain, const GroundBody& literals)
{
  Knowledge known(domain);
  for (const GroundLiteral& literal : literals)
  {
    known.add(literal);
  }
  closeUnderConstraints(known, domain);
  return known;
}

/// Whether no state can contain these literals, as far as their closure shows.
bool contradicts(const Knowledge& known, const GroundDomain& domain)
{
  for (int f = 0; f < static_cast<int>(domain.fluents.size()); ++f)
  {
    const auto count = static_cast<int>(domain.fluents[static_cast<std::size_t>(f)].values.size());
    for (int value = 0; value < count; ++value)
    {
      const GroundLiteral literal{f, value, true};
      if (known.has(literal) && known.has(contrary(literal, domain)))
      {
        return true;
      }
    }
  }
  return std::any_of(domain.constraints.begin(), domain.constraints.end(),
                     [&](const GroundConstraint& constraint) {
    return !constraint.head && known.has(constraint.body);
  });
}

/// Finds closures for one set of initial literals.
class ClosureSearch
{
public:
  ClosureSearch(const GroundDomain& domain, const GroundBody& initially)
    : domain_(domain), initially_(initially), base_(closed(domain, initially))
  {
    const auto with = [&](std::vector<int> defaults) {
      GroundBody literals = initially;
      for (const int d : defaults)
      {
        literals.push_back(head(d));
      }
      return contradicts(closed(domain, literals), domain);
    };
    for (const auto& [better, worse] : domain.better)
    {
      if (!with({better}) && !with({worse}) && with({better, worse}))
      {
        rivals_.emplace(better, worse);
      }
    }
  }

  std::set<Knowledge> run()
  {
    GroundBody heads;
    for (int d = 0; d < count(); ++d)
    {
      const bool known = std::any_of(heads.begin(), heads.end(), [&](const GroundLiteral& other) {
        return std::tie(other.fluent, other.value, other.equal) ==
               std::tie(head(d).fluent, head(d).value, head(d).equal);
      });
      if (!known)
      {
        heads.push_back(head(d));
      }
    }
    if (heads.size() > kMaxHeads)
    {
      throw ResourceExhausted("too many heads of defaults to enumerate");
    }
    std::set<Knowledge> found;
    for (std::size_t mask = 0; mask < (std::size_t{1} << heads.size()); ++mask)
    {
      GroundBody literals = initially_;
      for (std::size_t i = 0; i < heads.size(); ++i)
      {
        if ((mask >> i & 1U) != 0)
        {
          literals.push_back(heads[i]);
        }
      }
      const Knowledge candidate = closed(domain_, literals);
      if (rebuilt(candidate) == candidate)
      {
        found.insert(candidate);
      }
    }
    return found;
  }

private:
  [[nodiscard]] int count() const { return static_cast<int>(domain_.defaults.size()); }
  [[nodiscard]] const GroundLiteral& head(int d) const
  {
    return domain_.defaults[static_cast<std::size_t>(d)].head;
  }
  [[nodiscard]] const GroundBody& body(int d) const
  {
    return domain_.defaults[static_cast<std::size_t>(d)].body;
  }

  [[nodiscard]] bool blocked(int d, const Knowledge& closure) const
  {
    return std::any_of(rivals_.begin(), rivals_.end(), [&](const auto& pair) {
      return pair.second == d && closure.has(body(pair.first)) &&
             !closure.has(contrary(head(pair.first), domain_)) && !blocked(pair.first, closure);
    });
  }

  /// What can be concluded step by step, if `closure` is what will be known in the end. A default
  /// joins when its body is known; when, in the end, the contrary of its head is not; and when
  /// every better rival is out of the way: its body will not be known, or it is blocked itself, or
  /// the contrary of its head is known already.
  [[nodiscard]] Knowledge rebuilt(const Knowledge& closure) const
  {
    Knowledge known = base_;
    for (bool changed = true; changed;)
    {
      changed = false;
      for (int d = 0; d < count(); ++d)
      {
        const bool free = std::all_of(rivals_.begin(), rivals_.end(), [&](const auto& pair) {
          const int rival = pair.first;
          return pair.second != d || !closure.has(body(rival)) || blocked(rival, closure) ||
                 known.has(contrary(head(rival), domain_));
        });
        if (free && known.has(body(d)) && !closure.has(contrary(head(d), domain_)))
        {
          changed = known.add(head(d)) || changed;
        }
      }
      closeUnderConstraints(known, domain_);
    }
    return known;
  }

  const GroundDomain& domain_;
  const GroundBody& initially_;
  Knowledge base_;
  std::set<std::pair<int, int>> rivals_;  ///< (better, worse), with heads that exclude each other
};

}  // namespace

std::set<Knowledge> closures(const GroundDomain& domain, const GroundBody& initially)
{
  return ClosureSearch(domain, initially).run();
}

}  // namespace kr3::reasoner::oracle
