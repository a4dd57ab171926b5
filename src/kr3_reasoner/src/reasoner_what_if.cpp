#include <algorithm>
#include <utility>

#include "reasoner_impl.hpp"

namespace kr3::reasoner
{

namespace
{

constexpr std::size_t kMaxRetractions = 8;

}  // namespace

Reasoner Reasoner::supposing(const std::vector<Record>& hypothetical) const
{
  Reasoner reasoner(
      std::make_unique<Impl>(impl_->knowledge(), impl_->leastStep(), impl_->beginning()));
  reasoner.impl_->setLimits(impl_->limits());
  reasoner.impl_->take(impl_->records());
  reasoner.impl_->add(hypothetical);
  return reasoner;
}

std::vector<Retraction> Reasoner::retractions() const
{
  const auto question = impl_->ask("the search for retractions");
  const std::optional<Optimum>& optimum = impl_->optimum();
  if (optimum && optimum->price.total().retractions == 0)
  {
    return {};
  }
  return impl_->retractions({}, 0, kMaxRetractions, [](const Reasoner& reduced, std::string&) {
    const Diagnosis diagnosis = reduced.diagnose();
    return diagnosis.consistent &&
           std::all_of(diagnosis.alternatives.begin(), diagnosis.alternatives.end(),
                       [](const ExplanationAlternative& alternative) {
      return std::none_of(alternative.assumptions.begin(), alternative.assumptions.end(),
                          [](const Assumption& assumption) {
        return assumption.kind == AssumptionKind::kWrongRecord;
      });
           });
  });
}

std::vector<Retraction> Reasoner::retractionsFor(const std::string& literal, int step) const
{
  const auto question = impl_->ask("the search for retractions");
  const Literal wanted =
      normalized(parseGroundLiteral(literal, impl_->description()), impl_->description());
  impl_->checkStep(step);
  if ((impl_->optimum() && possible(literal, step)) || impl_->atAnyPrice().inSome(wanted, step))
  {
    return {};
  }
  if (auto contrary_ones = impl_->givingUpContrary(wanted, step))
  {
    return std::move(*contrary_ones);
  }
  return impl_->retractions({contrary(wanted, impl_->description())}, step, kMaxRetractions,
                            [&](const Reasoner& reduced, std::string& opens) {
    opens = toString(wanted, impl_->description());
    return reduced.impl_->optimum() && reduced.possible(literal, step);
  });
}

Retraction Reasoner::leastCertainRefutation(const std::string& fluent) const
{
  const auto question = impl_->ask("the search for retractions");
  const int now = impl_->currentStep();
  const GroundFluent ground = impl_->groundFluent(fluent);
  const Consequences any = impl_->atAnyPrice();
  std::vector<Literal> possible_now;
  for (const std::string& value : ground.values)
  {
    const Literal literal = literalOf(ground, value);
    if (any.inSome(literal, now))
    {
      possible_now.push_back(literal);
    }
  }
  const auto found =
      impl_->retractions(possible_now, now, 1, [&](const Reasoner& reduced, std::string& opens) {
        if (!reduced.impl_->optimum())
        {
          return false;
        }
        for (const std::string& value : reduced.possibleValues(fluent, now))
        {
          const Literal literal = literalOf(ground, value);
          if (!any.inSome(literal, now))
          {
            opens = toString(literal, impl_->description());
            return true;
          }
        }
        return false;
      });
  return found.empty() ? Retraction{} : found.front();
}

}  // namespace kr3::reasoner
