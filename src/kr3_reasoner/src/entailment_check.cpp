#include "entailment_check.hpp"

#include <algorithm>

#include "law_switches.hpp"

namespace kr3::reasoner
{

namespace
{

const char* const kSwitches = R"(
#external allowed(exogenous).
#external allowed(retraction).
:- ab(exo(_,_)), not allowed(exogenous).
:- ab(wrong(_)), not allowed(retraction).
#external off(_D) : hd(_D,_,_,_).
#project ab/1. #project c/2. #project cn/2.
#show c/2. #show cn/2.
)";

Clingo::Symbol closureAtom(const Literal& literal)
{
  const std::string text = (literal.equal ? "c(" : "cn(") + Encoding::term(literal.atom) + "," +
                           literal.value.name + ")";
  return Clingo::parse_term(text.c_str());
}

}  // namespace

bool InitialWorld::knows(const Literal& literal) const
{
  return closure.count(closureAtom(literal)) > 0;
}

HistoryCheck::HistoryCheck(const Description& description, const HistoryProgram& program,
                           const std::vector<CheckedRecord>& records, int current_step)
  : description_(description)
  , laws_(description)
  , switchable_(switchable(description, laws_))
  , program_(switchable_, program.options(), program.sharedBeginning())
  , num_records_(records.size())
  , levels_(assumableLevels(records, current_step, program.options().diagnose_exogenous,
                            program.beginning() != nullptr && program.beginning()->uncertain))
  , solver_(std::make_unique<Solver>(
        std::vector<std::string>{"0", "--opt-strategy=usc", "--project=project", "--warn=none"},
        program.limit()))
{
  program_.addTo(*solver_);
  // with what they switch, lest that be simplified away
  solver_->add("base", {}, kSwitches + lawSwitches());
  solver_->add("state", {"_t"}, openDefinitions(description, laws_));
  program_.groundHistory(*solver_, records, current_step, {current_step > 0, true}, true);
  solver_->ground({{"minimize", {}}});
  if (firstStep() > 0)
  {
    set(Clingo::Id("begun"), true);
  }
  const Clingo::SymbolicAtoms atoms = solver_->control().symbolic_atoms();
  for (auto it = atoms.begin(Clingo::Signature("off", 1)); it; ++it)
  {
    const Clingo::Symbol instance = it->symbol().arguments()[0];
    defaults_[toText(instance.arguments()[0])].push_back(it->symbol());
  }
}

void HistoryCheck::set(const Clingo::Symbol& external, bool value)
{
  const auto known = externals_.emplace(external, false).first;  // as clingo begins
  if (known->second != value)
  {
    known->second = value;
    solver_->control().assign_external(
        external, value ? Clingo::TruthValue::True : Clingo::TruthValue::False);
  }
}

bool HistoryCheck::entailWithoutBeginning(const Cited& kept, const Literal& literal, int step)
{
  set(Clingo::Id("begun"), false);
  const bool entailed = entail(kept, literal, step);
  set(Clingo::Id("begun"), true);
  return entailed;
}

void HistoryCheck::choose(const Cited& kept)
{
  for (std::size_t i = 0; i < num_records_; ++i)
  {
    set(Clingo::Function("rec", {Clingo::Number(static_cast<int>(i))}), kept.records.count(i) > 0);
  }
  for (std::size_t i = 0; i < laws_.size(); ++i)
  {
    set(switchOf(i), kept.laws.count(i) > 0);
  }
  for (const auto& [name, switches] : defaults_)
  {
    for (const Clingo::Symbol& off : switches)
    {
      set(off, kept.defaults.count(name) == 0);
    }
  }
}

void HistoryCheck::allow(const Assumable& assumable)
{
  set(Clingo::Function("allowed", {Clingo::Id("exogenous")}), assumable.exogenous);
  set(Clingo::Function("allowed", {Clingo::Id("retraction")}), assumable.retractions);
}

void HistoryCheck::bound(const std::vector<std::int64_t>* cost)
{
  std::string mode = cost == nullptr ? "opt" : "enum";
  if (cost != nullptr)
  {
    for (const std::int64_t level : *cost)
    {
      mode += "," + std::to_string(level);
    }
  }
  solver_->configure("solve.opt_mode", mode);
}

std::optional<std::vector<std::int64_t>> HistoryCheck::leastCost()
{
  bound(nullptr);
  solver_->configure("solve.models", "0");
  std::optional<std::vector<std::int64_t>> best;
  solver_->solve([&](const Clingo::Model& model) {
    best = model.cost();
    return true;
  });
  return best;
}

std::optional<std::vector<std::int64_t>> HistoryCheck::minimalExplanation(const Cited& kept)
{
  choose(kept);
  for (const Assumable& level : levels_)
  {
    allow(level);
    if (auto cost = leastCost())
    {
      return cost;
    }
  }
  return std::nullopt;
}

bool HistoryCheck::hasModel(const std::vector<std::int64_t>& cost,
                            const std::vector<Clingo::literal_t>& assumptions)
{
  bound(&cost);
  solver_->configure("solve.models", "1");
  return solver_->isSatisfiable(assumptions);
}

bool HistoryCheck::entail(const Cited& kept, const Literal& open, int step)
{
  const Literal literal = normalized(open, description_);
  const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
  const bool by_falsity = fluent.kind == FluentKind::kDefined && literal.value.name == "false";
  const std::string atom = "h(" + Encoding::term(literal.atom) + "," +
                           (by_falsity ? "true" : literal.value.name) + "," + std::to_string(step) +
                           ")";
  const bool wants_true = literal.equal && !by_falsity;
  const auto cost = minimalExplanation(kept);
  if (!cost)
  {
    return false;
  }
  const Clingo::SymbolicAtoms atoms = solver_->control().symbolic_atoms();
  auto found = atoms.find(Clingo::parse_term(atom.c_str()));
  return found ? !hasModel(*cost, {wants_true ? -found->literal() : found->literal()})
               : !wants_true;
}

Cited HistoryCheck::all() const
{
  Cited all;
  for (std::size_t i = 0; i < num_records_; ++i)
  {
    all.records.insert(i);
  }
  for (const auto& [name, switches] : defaults_)
  {
    all.defaults.insert(name);
  }
  for (std::size_t i = 0; i < laws_.size(); ++i)
  {
    all.laws.insert(i);
  }
  return all;
}

std::vector<InitialWorld> HistoryCheck::worlds(const Cited& kept, std::size_t limit)
{
  std::vector<InitialWorld> worlds;
  const auto cost = minimalExplanation(kept);
  if (!cost)
  {
    return worlds;
  }
  bound(&*cost);
  solver_->configure("solve.models", std::to_string(limit + 1));
  solver_->solve([&](const Clingo::Model& model) {
    InitialWorld world;
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      if (symbol.match("ab", 1))
      {
        world.assumed.push_back(symbol.arguments()[0]);
      }
      else if (symbol.match("c", 2) || symbol.match("cn", 2))
      {
        world.closure.insert(symbol);
      }
    }
    std::sort(world.assumed.begin(), world.assumed.end());
    worlds.push_back(std::move(world));
    return true;
  });
  if (worlds.size() > limit)
  {
    worlds.clear();
  }
  return worlds;
}

}  // namespace kr3::reasoner
