#include "step_grounder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "step_parts.hpp"

namespace kr3::reasoner
{

namespace
{

bool comparesActions(const Executability& rule)
{
  const auto isActionVariable = [&](const Term& term) {
    return term.is_variable &&
           std::any_of(rule.actions.begin(), rule.actions.end(), [&](const auto& action) {
             const auto* variable = std::get_if<Term>(&action);
             return variable != nullptr && variable->name == term.name;
           });
  };
  return std::any_of(rule.body.begin(), rule.body.end(), [&](const Condition& condition) {
    const auto* comparison = std::get_if<Comparison>(&condition);
    return comparison != nullptr && comparison->op != Comparison::Operator::kEqual &&
           comparison->op != Comparison::Operator::kNotEqual &&
           (isActionVariable(comparison->left) || isActionVariable(comparison->right));
  });
}

}  // namespace

bool canGroundStep(const Description& description)
{
  return description.asp_blocks.empty() &&
         std::none_of(description.executabilities.begin(), description.executabilities.end(),
                      comparesActions);
}

void groundPrices(const StepContext& context)
{
  constexpr double kMilli = 1000.0;
  StepProgram& program = context.program;
  for (const ActionCost& cost : context.vocabulary.description().costs)
  {
    const int symbol = context.vocabulary.actionSymbol(cost.action.name);
    if (!context.signature.hasAction(symbol))
    {
      continue;
    }
    StepBody body(context);
    const std::vector<Slot> arguments = body.reader().action(cost.action);
    for (const Condition& condition : cost.body)
    {
      body.addBefore(condition);
    }
    std::vector<bool> wanted(body.reader().variables().size(), false);
    markVariables(arguments, wanted);
    const long milli = std::lround(cost.cost * kMilli);
    std::vector<std::int32_t> literals;
    body.forEach(wanted, [&](const RuleBinding& binding) {
      literals.clear();
      if (!body.write(binding, literals))
      {
        return;
      }
      auto& prices = program.prices_of[static_cast<std::size_t>(
          context.signature.action(symbol, arguments, binding))];
      auto known = std::find_if(prices.begin(), prices.end(), [&](const StepProgram::Price& price) {
        return price.cost_milli == milli;
      });
      if (known == prices.end())
      {
        known = prices.insert(known, {milli, context.atoms.fresh()});
      }
      program.prices.addRule(false, {&known->atom, &known->atom + 1},
                             {literals.data(), literals.data() + literals.size()});
    });
  }
}

StepProgram groundStep(Vocabulary& vocabulary, const Statics& statics, const Signature& signature,
                       const SearchLimit& limit)
{
  const Description& description = vocabulary.description();
  StepProgram program;
  StepAtoms atoms(signature);
  const StepContext context{vocabulary, statics, signature, atoms, program, limit};
  program.impossible.assign(signature.numActions(), 0);
  program.prices_of.resize(signature.numActions());
  for (std::size_t action = 0; action < signature.numActions(); ++action)
  {
    program.occurs.push_back(atoms.occurs(static_cast<int>(action)));
  }
  watchCircular(context);
  for (const Executability& rule : description.executabilities)
  {
    groundExecutability(context, rule);
  }
  groundPrices(context);
  atoms.beginNow();
  for (std::size_t i = 0; i < description.causal_laws.size(); ++i)
  {
    groundLaw(context, description.causal_laws[i], i);
  }
  for (const Executability& rule : description.executabilities)
  {
    groundExclusion(context, rule);
  }
  groundConstraints(context);
  for (std::size_t value = 0; value < signature.numValues(); ++value)
  {
    program.before.push_back(atoms.before(static_cast<int>(value)));
    program.now.push_back(atoms.now(static_cast<int>(value)));
  }
  for (std::size_t number = 0; number < atoms.watched().size(); ++number)
  {
    program.before.push_back(atoms.unequalBefore(number));
    program.now.push_back(atoms.unequalNow(number));
  }
  for (auto& prices : program.prices_of)
  {
    std::sort(prices.begin(), prices.end(),
              [](const auto& a, const auto& b) { return a.cost_milli > b.cost_milli; });
  }
  return program;
}

}  // namespace kr3::reasoner
