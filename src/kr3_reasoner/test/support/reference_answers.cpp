#include <algorithm>
#include <string_view>

#include <clingo.hh>

#include "reference_program.hpp"

namespace kr3::reasoner::oracle
{

namespace
{

std::vector<Level> levelsOf(const std::vector<Record>& records, const ReasonerOptions& options)
{
  std::vector<Level> levels = {{options.diagnose_exogenous, false}, {true, false}};
  if (std::any_of(records.begin(), records.end(), [](const Record& record) {
        return record.confidence < 1.0 && record.kind != RecordKind::kHappened &&
               record.kind != RecordKind::kAttempted;
      }))
  {
    levels.push_back({options.diagnose_exogenous, true});
    levels.push_back({true, true});
  }
  return levels;
}

int lastStep(const std::vector<Record>& records)
{
  int last = 0;
  for (const Record& record : records)
  {
    const bool is_action =
        record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
    last = std::max(last, record.step + (is_action ? 1 : 0));
  }
  return last;
}

std::string statementOf(const Clingo::Symbol& assumed, const GroundDomain& domain,
                        const std::vector<Record>& records)
{
  const auto first = static_cast<std::size_t>(assumed.arguments()[0].number());
  if (assumed.match("e", 1))
  {
    const GroundLiteral exception = contrary(domain.defaults[first].head, domain);
    const bool negative = domain.fluents[static_cast<std::size_t>(exception.fluent)].boolean
                              ? exception.value == 0
                              : !exception.equal;
    const GroundLiteral shown = negative ? contrary(exception, domain) : exception;
    return "init(" + toString(shown, domain) + (negative ? ", false)" : ", true)");
  }
  if (assumed.match("wrong", 1))
  {
    return "wrong(" + toString(records[first]) + ")";
  }
  const std::string step = assumed.arguments()[1].to_string();
  const std::string& action = domain.actions[first].name;
  return assumed.match("fail", 2) ? "failed(" + action + ", " + step + ")" : action + " at " + step;
}

Model modelOf(const Clingo::SymbolVector& shown, const GroundDomain& domain,
              const std::vector<Record>& records)
{
  Model model;
  model.states.assign(static_cast<std::size_t>(lastStep(records)) + 1,
                      Values(domain.fluents.size(), 0));
  for (const Clingo::Symbol& symbol : shown)
  {
    if (symbol.match("holds", 3) && symbol.is_positive())
    {
      const auto arguments = symbol.arguments();
      model.states[static_cast<std::size_t>(arguments[2].number())]
                  [static_cast<std::size_t>(arguments[0].number())] = arguments[1].number();
    }
    else if (symbol.match("assumed", 1))
    {
      model.assumed.push_back(statementOf(symbol.arguments()[0], domain, records));
    }
  }
  std::sort(model.assumed.begin(), model.assumed.end());
  return model;
}

}  // namespace

Answers referenceAnswers(const Description& description, const std::vector<Record>& records,
                         const ReasonerOptions& options)
{
  const GroundDomain domain = grounded(description);
  for (const Level& level : levelsOf(records, options))
  {
    Clingo::Control control({"0", "--opt-mode=optN", "--warn=none"});
    control.add("base", {}, referenceProgram(domain, description, records, options, level).c_str());
    control.ground({{"base", {}}});
    Answers answers;
    for (const Clingo::Model& model : control.solve())
    {
      if (model.optimality_proven() || model.cost().empty())  // nothing to pay: no optimization
      {
        answers.consistent = true;
        answers.cost = 0;
        for (const std::int64_t cost : model.cost())
        {
          answers.cost += static_cast<int>(cost);
        }
        answers.models.insert(modelOf(model.symbols(), domain, records));
      }
    }
    if (answers.consistent)
    {
      return answers;
    }
  }
  return {};
}

Consequences referenceConsequences(const Description& description,
                                   const std::vector<Record>& records,
                                   const ReasonerOptions& options)
{
  const GroundDomain domain = grounded(description);
  for (const Level& level : levelsOf(records, options))
  {
    const std::string program = referenceProgram(domain, description, records, options, level);
    Clingo::Control best({"0", "--warn=none"});
    best.add("base", {}, program.c_str());
    best.ground({{"base", {}}});
    Consequences result;
    std::map<int, std::int64_t> bounds = {{1, 0}, {2, 0}};
    for (const Clingo::Model& model : best.solve())
    {
      result.consistent = true;
      result.cost = 0;
      const auto costs = model.cost();
      const auto levels = model.priorities();
      for (std::size_t i = 0; i < costs.size(); ++i)
      {
        bounds[levels[i]] = costs[i];
        result.cost += static_cast<int>(costs[i]);
      }
    }
    if (!result.consistent)
    {
      continue;
    }
    Clingo::Control brave({"0", "--enum-mode=brave", "--opt-mode=ignore", "--warn=none"});
    brave.add("base", {},
              (program + ":- #sum { P,X : price(X,P), assumed(X) } > " + std::to_string(bounds[1]) +
               ".\n:- #sum { P,X : doubt(X,P), assumed(X) } > " + std::to_string(bounds[2]) +
               ".\n#show -holds/3.\n")
                  .c_str());
    brave.ground({{"base", {}}});
    result.possible.assign(static_cast<std::size_t>(lastStep(records)) + 1,
                           std::vector<std::set<int>>(domain.fluents.size()));
    for (const Clingo::Model& model : brave.solve())
    {
      for (const Clingo::Symbol& symbol : model.symbols())
      {
        if (std::string_view(symbol.name()) != "holds")
        {
          continue;
        }
        const auto arguments = symbol.arguments();
        const auto fluent = static_cast<std::size_t>(arguments[0].number());
        if (symbol.is_positive() || domain.fluents[fluent].boolean)
        {
          result.possible[static_cast<std::size_t>(arguments[2].number())][fluent].insert(
              symbol.is_positive() ? arguments[1].number() : 0);
        }
      }
    }
    return result;
  }
  return {};
}

}  // namespace kr3::reasoner::oracle
