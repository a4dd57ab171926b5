#include "models.hpp"

#include <algorithm>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

std::optional<Price> minimalPrice(const HistoryProgram& program,
                                  const std::vector<CheckedRecord>& records, int current_step,
                                  const Assumable& assumable)
{
  Solver solver({"0", "--opt-strategy=usc", "--warn=none"});
  program.addTo(solver);
  program.groundHistory(solver, records, current_step, assumable);
  solver.ground({{"minimize", {}}});
  std::optional<Price> best;
  for (const Clingo::Model& model : solver.control().solve())
  {
    const std::vector<std::int64_t> cost = model.cost();
    // clingo leaves a level out when nothing can be paid there
    Price price;
    const auto priorities = model.priorities();
    for (std::size_t i = 0; i < cost.size(); ++i)
    {
      (priorities[i] == 2 ? price.retractions : price.assumptions) = static_cast<int>(cost[i]);
    }
    best = price;
  }
  return best;
}

// That an impossible attempt failed has no price: it follows, and explains nothing.
const char* const kAssumedRules = R"(
assumed(_X) :- ab(_X), weight(_X,_).
assumed(_X) :- ab(_X), doubt(_X,_).
#show assumed/1.
)";

Literal positive(const Literal& literal)
{
  Literal equal = literal;
  equal.equal = true;
  return equal;
}

}  // namespace

std::optional<Optimum> findOptimum(const HistoryProgram& program,
                                   const std::vector<CheckedRecord>& records, int current_step,
                                   bool exogenous_first, const ExplanationStart& start)
{
  const bool uncertain = start.uncertain || std::any_of(records.begin(), records.end(),
                                                        [](const CheckedRecord& checked) {
    return !checked.isAction() && checked.record.confidence < 1.0;
                         });
  std::vector<Assumable> levels = {{exogenous_first, false}};
  if (!exogenous_first && current_step > 0)
  {
    levels.push_back({true, false});
  }
  if (uncertain)
  {
    levels.push_back({exogenous_first, true});
    levels.push_back({true, true});
  }
  for (auto level = static_cast<std::size_t>(start.level); level < levels.size(); ++level)
  {
    if (const auto price = minimalPrice(program, records, current_step, levels[level]))
    {
      return Optimum{levels[level], *price, static_cast<int>(level)};
    }
  }
  return std::nullopt;
}

Consequences::Consequences(const Description& description, const HistoryProgram& program,
                           const std::vector<CheckedRecord>& records, int current_step,
                           const Optimum& optimum)
  : description_(description)
{
  Solver solver({"0", "--warn=none"});
  program.addTo(solver);
  program.groundHistory(solver, records, current_step, optimum.assumable);
  HistoryProgram::groundBound(solver, optimum.price);
  const auto read = [&](const char* mode) {
    solver.configure("solve.enum_mode", mode);
    SymbolSet symbols;
    for (const Clingo::Model& model : solver.control().solve())
    {
      const auto shown = model.symbols(Clingo::ShowType::Shown);
      symbols = SymbolSet(shown.begin(), shown.end());  // the last is the answer
    }
    return symbols;
  };
  all_ = read("cautious");
  some_ = read("brave");
}

bool Consequences::has(const SymbolSet& set, const std::string& atom)
{
  return set.count(Clingo::parse_term(atom.c_str())) > 0;
}

bool Consequences::inAll(const Literal& open, int step) const
{
  const Literal literal = normalized(open, description_);
  if (!literal.equal)
  {
    return !inSome(positive(literal), step);
  }
  const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
  const std::string term = Encoding::term(literal.atom);
  if (!fluent.value_sort && fluent.kind == FluentKind::kDefined && literal.value.name == "false")
  {
    return !has(some_, "h(" + term + ",true," + std::to_string(step) + ")");
  }
  if (fluent.kind == FluentKind::kStatic)
  {
    return !fluent.value_sort && literal.value.name == "false"
               ? !has(some_, "st(" + term + ",true)")
               : has(all_, "st(" + term + "," + literal.value.name + ")");
  }
  return has(all_, "h(" + term + "," + literal.value.name + "," + std::to_string(step) + ")");
}

bool Consequences::inSome(const Literal& literal, int step) const
{
  const Literal normal = normalized(literal, description_);
  const FluentDeclaration& fluent = *description_.findFluent(normal.atom.name);
  const std::string term = Encoding::term(normal.atom);
  if (normal.equal && fluent.kind != FluentKind::kStatic &&
      (fluent.kind != FluentKind::kDefined || normal.value.name == "true"))
  {
    return has(some_, "h(" + term + "," + normal.value.name + "," + std::to_string(step) + ")");
  }
  if (normal.equal && fluent.kind == FluentKind::kStatic)
  {
    return inAll(normal, step);
  }
  // f != v is possible unless f = v is in all models; so is the falsity of a defined fluent.
  Literal opposite = normal;
  if (normal.equal)
  {
    opposite.value.name = "true";
  }
  opposite.equal = true;
  return !inAll(opposite, step);
}

std::vector<std::vector<Clingo::Symbol>> explanationsOf(const HistoryProgram& program,
                                                        const std::vector<CheckedRecord>& records,
                                                        int current_step, const Optimum& optimum)
{
  constexpr std::size_t kMaxExplanations = 200;
  if (optimum.price.assumptions == 0 && optimum.price.retractions == 0)
  {
    return {{}};
  }
  Solver solver({"0", "--project=project", "--warn=none"});
  program.addTo(solver);
  solver.add("project", {}, std::string(kAssumedRules) + "#project assumed/1.\n");
  program.groundHistory(solver, records, current_step, optimum.assumable);
  solver.ground({{"project", {}}});
  HistoryProgram::groundBound(solver, optimum.price);
  std::vector<std::vector<Clingo::Symbol>> explanations;
  for (const Clingo::Model& model : solver.control().solve())
  {
    std::vector<Clingo::Symbol> explanation;
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      if (symbol.match("assumed", 1))
      {
        explanation.push_back(symbol.arguments()[0]);
      }
    }
    std::sort(explanation.begin(), explanation.end());
    explanations.push_back(std::move(explanation));
    if (explanations.size() == kMaxExplanations)
    {
      break;
    }
  }
  std::sort(explanations.begin(), explanations.end());
  return explanations;
}

std::vector<SymbolicModel> modelsOf(const HistoryProgram& program,
                                    const std::vector<CheckedRecord>& records, int current_step,
                                    const Optimum& optimum, std::size_t limit)
{
  Solver solver({std::to_string(limit), "--project=project", "--warn=none"});
  program.addTo(solver);
  solver.add("project", {},
             std::string(kAssumedRules) + "#project assumed/1. #project h/3. #show occ/2.\n");
  program.groundHistory(solver, records, current_step, optimum.assumable);
  solver.ground({{"project", {}}});
  HistoryProgram::groundBound(solver, optimum.price);
  std::vector<SymbolicModel> models;
  for (const Clingo::Model& model : solver.control().solve())
  {
    SymbolicModel read;
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      if (symbol.match("assumed", 1))
      {
        read.assumed.push_back(symbol.arguments()[0]);
      }
      else if (symbol.match("h", 3))
      {
        read.holds.push_back(symbol);
      }
      else if (symbol.match("occ", 2))
      {
        read.occurs.push_back(symbol);
      }
    }
    std::sort(read.assumed.begin(), read.assumed.end());
    std::sort(read.occurs.begin(), read.occurs.end());
    models.push_back(std::move(read));
  }
  return models;
}

std::vector<std::string> firingDefaults(const HistoryProgram& program,
                                        const std::vector<CheckedRecord>& records, int current_step,
                                        const Optimum& optimum, const Atom& fluent)
{
  Solver solver({"0", "--enum-mode=cautious", "--warn=none"});
  program.addTo(solver);
  const std::string head = Encoding::term(fluent);
  solver.add(
      "show", {},
      "applied(_N) :- fires(_D), _D = d(_N,_), hd(_D," + head + ",_,_).\n" + "#show applied/1.\n");
  program.groundHistory(solver, records, current_step, optimum.assumable);
  solver.ground({{"show", {}}});
  HistoryProgram::groundBound(solver, optimum.price);
  std::vector<std::string> names;
  for (const Clingo::Model& model : solver.control().solve())
  {
    names.clear();
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      if (symbol.match("applied", 1))
      {
        names.push_back(toText(symbol.arguments()[0]));
      }
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::size_t> minimalConflict(const HistoryProgram& program,
                                         const std::vector<CheckedRecord>& records,
                                         int current_step)
{
  Solver solver({"1", "--warn=none"});
  program.addTo(solver);
  program.groundHistory(solver, records, current_step, {true, true}, true);
  std::vector<bool> kept(records.size(), true);
  const auto consistent = [&] {
    for (std::size_t i = 0; i < records.size(); ++i)
    {
      solver.control().assign_external(
          Clingo::Function("rec", {Clingo::Number(static_cast<int>(i))}),
          kept[i] ? Clingo::TruthValue::True : Clingo::TruthValue::False);
    }
    return solver.control().solve().get().is_satisfiable();
  };
  // Whatever is not needed for the conflict goes, one record after the other.
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    kept[i] = false;
    if (consistent())
    {
      kept[i] = true;
    }
  }
  std::vector<std::size_t> conflict;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    if (kept[i])
    {
      conflict.push_back(i);
    }
  }
  return conflict;
}

}  // namespace kr3::reasoner
