#include "propagation.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace kr3::reasoner
{

int Propagation::addVariable(int size)
{
  const int variable = static_cast<int>(sizes_.size());
  sizes_.push_back(size);
  offsets_.push_back(num_literals_);
  num_literals_ += 2 * static_cast<std::size_t>(size);
  known_.resize(num_literals_, -1);
  trail_place_.resize(num_literals_, 0);
  falsifies_.resize(num_literals_);
  satisfies_.resize(num_literals_);
  num_excluded_.push_back(0);
  if (size == 1)
  {
    conclude({variable, 0, true, 0}, Inference::kOnlyValue, {}, {});
  }
  return variable;
}

FiniteLiteral Propagation::canonical(FiniteLiteral literal) const
{
  if (sizes_[static_cast<std::size_t>(literal.variable)] == 2 && !literal.equal)
  {
    literal.value = 1 - literal.value;
    literal.equal = true;
  }
  return literal;
}

FiniteLiteral Propagation::negated(FiniteLiteral literal) const
{
  literal.equal = !literal.equal;
  return canonical(literal);
}

std::size_t Propagation::index(const FiniteLiteral& open) const
{
  const FiniteLiteral literal = canonical(open);
  return offsets_[static_cast<std::size_t>(literal.variable)] +
         2 * static_cast<std::size_t>(literal.value) + (literal.equal ? 1U : 0U);
}

int Propagation::find(const FiniteLiteral& literal) const
{
  return known_[index(literal)];
}

/// What is known but waits to be processed is counted when it is.
bool Propagation::isProcessed(std::size_t place) const
{
  return known_[place] >= 0 && trail_place_[place] < num_processed_;
}

void Propagation::addClause(const std::vector<FiniteLiteral>& literals, int origin)
{
  Clause clause;
  clause.origin = origin;
  for (const FiniteLiteral& literal : literals)
  {
    const ClauseLiteral& added = clause.literals.emplace_back(
        ClauseLiteral{literal, index(literal), index(negated(literal))});
    falsifies_[added.negated].push_back(clauses_.size());
    satisfies_[added.place].push_back(clauses_.size());
    clause.num_false += isProcessed(added.negated) ? 1 : 0;
    clause.num_true += isProcessed(added.place) ? 1 : 0;
  }
  clauses_.push_back(std::move(clause));
  if (clauses_.back().num_false + 1 >= clauses_.back().literals.size())
  {
    const Clause last = clauses_.back();
    concludeFrom(last);
  }
}

void Propagation::addFoundedRule(FiniteLiteral head, std::vector<FiniteLiteral> body, int origin)
{
  founded_.push_back({head, std::move(body), origin});
}

int Propagation::addInference(Inference inference)
{
  inferences_.push_back(std::move(inference));
  return static_cast<int>(inferences_.size()) - 1;
}

void Propagation::assume(int inference)
{
  const FiniteLiteral literal = this->inference(inference).literal;
  if (find(literal) < 0)
  {
    know(literal, inference);
  }
}

void Propagation::know(const FiniteLiteral& literal, int inference)
{
  const int contrary = find(negated(literal));
  if (contrary >= 0)
  {
    if (contradiction_ < 0)
    {
      const int at = literal.step;
      contradiction_ = addInference({{}, Inference::kClash, {contrary, inference}, {at, at}});
    }
    return;
  }
  const std::size_t place = index(literal);
  known_[place] = inference;
  trail_place_[place] = trail_.size();
  trail_.push_back(literal);
}

void Propagation::conclude(const FiniteLiteral& literal, int origin, std::vector<int> antecedents,
                           std::vector<int> used_at)
{
  if (find(literal) < 0)
  {
    know(literal, addInference({literal, origin, std::move(antecedents), std::move(used_at)}));
  }
}

void Propagation::concludeFrom(const Clause& clause)
{
  const FiniteLiteral* open = nullptr;
  for (const auto& [literal, place, negated] : clause.literals)
  {
    if (known_[negated] >= 0)
    {
      continue;
    }
    if (open != nullptr || known_[place] >= 0)
    {
      return;  // satisfied, or more than one literal is open
    }
    open = &literal;
  }
  std::vector<int> antecedents;
  std::vector<int> used_at;
  for (const auto& [literal, place, negated] : clause.literals)
  {
    if (known_[negated] >= 0)
    {
      antecedents.push_back(known_[negated]);
      used_at.push_back(literal.step);
    }
  }
  if (open != nullptr)
  {
    conclude(*open, clause.origin, std::move(antecedents), std::move(used_at));
  }
  else if (contradiction_ < 0)
  {
    contradiction_ = addInference({{}, clause.origin, std::move(antecedents), std::move(used_at)});
  }
}

void Propagation::process(const FiniteLiteral& open)
{
  const FiniteLiteral literal = canonical(open);
  const std::size_t place = index(literal);
  const int reason = known_[place];
  const auto variable = static_cast<std::size_t>(literal.variable);
  const int size = sizes_[variable];
  for (const std::size_t i : satisfies_[place])
  {
    ++clauses_[i].num_true;
  }
  for (const std::size_t i : falsifies_[place])
  {
    Clause& clause = clauses_[i];
    ++clause.num_false;
    if (contradiction_ < 0 && clause.num_false + 1 >= clause.literals.size())
    {
      concludeFrom(clause);
    }
  }
  num_excluded_[variable] += !literal.equal ? 1 : 0;
  if (size <= 2 || contradiction_ >= 0)
  {
    return;
  }
  if (literal.equal)
  {
    for (int value = 0; value < size; ++value)
    {
      if (value != literal.value)
      {
        conclude({literal.variable, value, false, literal.step}, Inference::kImplied, {reason},
                 {literal.step});
      }
    }
    return;
  }
  if (num_excluded_[variable] == size - 1)
  {
    std::vector<int> antecedents;
    int left = 0;
    for (int value = 0; value < size; ++value)
    {
      const int excluded = find({literal.variable, value, false, 0});
      if (excluded >= 0)
      {
        antecedents.push_back(excluded);
      }
      else
      {
        left = value;
      }
    }
    std::vector<int> used_at(antecedents.size(), literal.step);
    conclude({literal.variable, left, true, literal.step}, Inference::kOnlyValue,
             std::move(antecedents), std::move(used_at));
  }
}

int Propagation::propagate()
{
  limit_.check();
  do
  {
    while (contradiction_ < 0 && num_processed_ < trail_.size())
    {
      const FiniteLiteral next = trail_[num_processed_++];
      process(next);
    }
  } while (contradiction_ < 0 && concludeUnfounded());
  return contradiction_;
}

/// What no founded rule can give is false. Returns whether something new was concluded.
bool Propagation::concludeUnfounded()
{
  std::map<std::size_t, bool> can_hold;  // by the head's index
  for (const FoundedRule& rule : founded_)
  {
    can_hold.emplace(index(rule.head), false);
  }
  const auto isOpen = [&](const FoundedRule& rule) {
    return std::all_of(rule.body.begin(), rule.body.end(), [&](const FiniteLiteral& literal) {
      const auto head = can_hold.find(index(literal));
      return find(negated(literal)) < 0 && (head == can_hold.end() || head->second);
    });
  };
  for (bool grown = true; grown;)
  {
    grown = false;
    for (const FoundedRule& rule : founded_)
    {
      bool& possible = can_hold[index(rule.head)];
      if (!possible && isOpen(rule))
      {
        possible = grown = true;
      }
    }
  }
  bool concluded = false;
  for (const FoundedRule& rule : founded_)
  {
    if (can_hold[index(rule.head)] || find(negated(rule.head)) >= 0)
    {
      continue;
    }
    // Why: in the bodies of all rules of the set that cannot hold, what is false from outside.
    std::vector<int> antecedents;
    std::vector<int> used_at;
    for (const FoundedRule& other : founded_)
    {
      if (can_hold[index(other.head)])
      {
        continue;
      }
      for (const FiniteLiteral& literal : other.body)
      {
        const int falsifier = find(negated(literal));
        if (falsifier >= 0)
        {
          antecedents.push_back(falsifier);
          used_at.push_back(literal.step);
          break;
        }
      }
    }
    conclude(negated(rule.head), rule.origin, std::move(antecedents), std::move(used_at));
    concluded = true;
    break;  // conclusions change what can hold
  }
  return concluded;
}

void Propagation::undo(std::size_t mark)
{
  while (trail_.size() > mark)
  {
    const FiniteLiteral literal = canonical(trail_.back());
    const std::size_t place = index(literal);
    if (num_processed_ == trail_.size())
    {
      for (const std::size_t i : satisfies_[place])
      {
        --clauses_[i].num_true;
      }
      for (const std::size_t i : falsifies_[place])
      {
        --clauses_[i].num_false;
      }
      num_excluded_[static_cast<std::size_t>(literal.variable)] -= !literal.equal ? 1 : 0;
      --num_processed_;
    }
    known_[place] = -1;
    trail_.pop_back();
  }
  contradiction_ = -1;
}

int Propagation::suppose(const FiniteLiteral& literal, int& max_cases)
{
  const std::size_t mark = trail_.size();
  conclude(literal, Inference::kSupposed, {}, {});
  const int refutation = refuteByCases(max_cases);
  undo(mark);
  return refutation;
}

/// A literal of the unsatisfied clause that is nearest to a conclusion; all is processed.
const FiniteLiteral* Propagation::distinction() const
{
  constexpr std::size_t kFewest = 2;  // of one that is open propagation concludes
  const Clause* best = nullptr;
  std::size_t fewest = 0;
  for (const Clause& clause : clauses_)
  {
    const std::size_t open = clause.literals.size() - clause.num_false;
    if (clause.num_false == 0 || clause.num_true > 0 || (best != nullptr && open >= fewest))
    {
      continue;
    }
    best = &clause;
    fewest = open;
    if (fewest == kFewest)
    {
      break;
    }
  }
  if (best == nullptr)
  {
    return nullptr;
  }
  const auto first =
      std::find_if(best->literals.begin(), best->literals.end(),
                   [&](const ClauseLiteral& one) { return known_[one.negated] < 0; });
  return &first->literal;
}

int Propagation::refuteByCases(int& max_cases)
{
  if (propagate() >= 0)
  {
    return contradiction_;
  }
  const FiniteLiteral* best = max_cases-- > 0 ? distinction() : nullptr;
  if (best == nullptr)
  {
    return -1;
  }
  const FiniteLiteral literal = *best;
  const int first = suppose(literal, max_cases);
  const int second = first < 0 ? -1 : suppose(negated(literal), max_cases);
  return second < 0
             ? -1
             : addInference({{}, Inference::kCases, {first, second}, {literal.step, literal.step}});
}

int Propagation::refute(int max_cases)
{
  return refuteByCases(max_cases);
}

int Propagation::prove(const FiniteLiteral& literal, int max_cases)
{
  if (propagate() >= 0)
  {
    return -1;  // anything would follow
  }
  if (find(literal) < 0)
  {
    const int refutation = suppose(negated(literal), max_cases);
    if (refutation < 0)
    {
      return -1;
    }
    conclude(literal, Inference::kContradiction, {refutation}, {literal.step});
  }
  return find(literal);
}

}  // namespace kr3::reasoner
