#include "kr3_reasoner/ground_literals.hpp"

#include "ground_phrases.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

GroundLiterals::GroundLiterals(const Description& description)
  : symbols_(std::make_unique<const Symbols>(description))
{
}

GroundLiterals::~GroundLiterals() = default;

const Literal& GroundLiterals::of(const std::string& text)
{
  constexpr std::size_t kMany = 100000;  // more than a description has: spelt in many ways
  if (const auto found = known_.find(text); found != known_.end())
  {
    return found->second;
  }
  if (known_.size() >= kMany)
  {
    known_.clear();
  }
  return known_.emplace(text, parseGroundLiteral(text, *symbols_)).first->second;
}

}  // namespace kr3::reasoner
