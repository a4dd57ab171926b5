#include "plan_program.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <kr3_common/error.hpp>

#include "ground_fluents.hpp"

namespace kr3::reasoner
{

namespace
{

using Clock = std::chrono::steady_clock;

const char* const kPlanRules = R"(
{ pl(_A,t-1) : agent(_A) }.
occ(_A,t-1) :- pl(_A,t-1), not broken(t-1).
broken(t-1) :- pl(_A,t-1), imp(_A,t-1).
broken(t-1) :- broken(t-2).
busy(t-1) :- pl(_A,t-1).
tested(t) :- pl(_A,t-1), depends(_A,_F), open(_F).
tested(t) :- tested(t-1).
)";

// What a plan of length n must do in the model where it is looked for. `shorter`: it may end
// before.
const char* const kQueryRules = R"(
#external query(n). [free]
fails(n) :- not goal(n).
fails(n) :- broken(n-1).
:- query(n), fails(n).
:- query(n), not shorter, step(_T), _T < n, not busy(_T).
:- query(n), goal(now), not tested(n).
:- query(n), step(_T), _T < n, busy(_T), step(_T-1), not busy(_T-1).
)";

const char* const kCostRules = R"(
priced(_A,t-1) :- price(_A,t-1,_).
cheaper(_A,t-1,_C) :- price(_A,t-1,_C), price(_A,t-1,_D), _D > _C.
paid(_A,t-1,_C) :- price(_A,t-1,_C), not cheaper(_A,t-1,_C).
paid(_A,t-1,1000) :- pl(_A,t-1), not priced(_A,t-1).
#defined price/3.
)";

constexpr double kMilli = 1000.0;

Clingo::Symbol holds(const std::string& fluent, const std::string& value, int step)
{
  return Clingo::Function("h", {Clingo::parse_term(fluent.c_str()),
                                Clingo::parse_term(value.c_str()), Clingo::Number(step)});
}

Clingo::Symbol atom(const char* name, int step)
{
  return Clingo::Function(name, {Clingo::Number(step)});
}

Literal toLiteral(const GroundFluent& fluent, const std::string& value)
{
  Literal literal;
  literal.atom.name = fluent.symbol;
  for (const std::string& argument : fluent.arguments)
  {
    literal.atom.arguments.push_back({false, argument});
  }
  literal.value.name = value;
  return literal;
}

void collect(const Formula& formula, std::vector<Literal>& literals)
{
  if (formula.kind == Formula::Kind::kLiteral)
  {
    literals.push_back(formula.literal);
  }
  for (const Formula& operand : formula.operands)
  {
    collect(operand, literals);
  }
}

/// The name of the atom for a formula; its rules are added to `rules`.
std::string addFormula(const Formula& formula, const Description& description, int& num_parts,
                       std::string& rules)
{
  std::vector<std::string> operands;
  for (const Formula& operand : formula.operands)
  {
    operands.push_back(addFormula(operand, description, num_parts, rules));
  }
  const std::string name = "part(" + std::to_string(num_parts++) + ",n)";
  if (formula.kind == Formula::Kind::kLiteral)
  {
    rules += name + " :- " +
             Encoding(description).literal(normalized(formula.literal, description), "n") + ".\n";
    return name;
  }
  std::string conjunction;
  for (const std::string& operand : operands)
  {
    if (formula.kind == Formula::Kind::kOr)
    {
      rules += name + " :- " + operand + ".\n";
    }
    conjunction += (conjunction.empty() ? "" : ", ") +
                   std::string(formula.kind == Formula::Kind::kNot ? "not " : "") + operand;
  }
  if (formula.kind != Formula::Kind::kOr)
  {
    rules += name + " :- " + conjunction + ".\n";
  }
  return name;
}

}  // namespace

std::string formulaRules(const Formula& formula, const Description& description,
                         const std::string& root)
{
  std::string rules;
  int num_parts = 0;
  const std::string name = addFormula(formula, description, num_parts, rules);
  return rules + root + " :- " + name + ".\n";
}

PlanProgram::PlanProgram(const PlanningProblem& problem, const Formula& goal, int max_length,
                         PlanQuality quality, const SearchLimit& limit)
  : problem_(problem)
  , quality_(quality)
  , limit_(limit)
  , encoding_(problem.description)
  , solver_({"1", "--warn=none"})
  , has_costs_(!problem.description.costs.empty())
{
  findOpenFluents();
  build(goal, max_length);
}

void PlanProgram::findOpenFluents()
{
  for (const GroundFluent& fluent : groundFluents(problem_.description))
  {
    if (fluent.kind == FluentKind::kDefined)
    {
      continue;
    }
    Literal value = toLiteral(fluent, "");
    std::size_t possible = 0;
    for (const std::string& name : fluent.values)
    {
      value.value.name = name;
      possible += problem_.consequences.inSome(value, problem_.now) ? 1 : 0;
    }
    if (possible > 1)
    {
      open_index_.emplace(Encoding::term(value.atom), open_.size());
      open_.push_back(fluent);
    }
  }
}

void PlanProgram::build(const Formula& goal, int max_length)
{
  const int now = problem_.now;
  problem_.program.addTo(solver_);
  const bool any_length = quality_ == PlanQuality::kLeastCostAnyLength;
  std::string plan = kPlanRules;
  if (has_costs_)
  {
    plan += kCostRules + costRules();
  }
  const bool by_cost = quality_ == PlanQuality::kLeastCost || any_length;
  if (by_cost && has_costs_)
  {
    plan += "#minimize { _C@3,_A,t : paid(_A,t-1,_C) }.\n";
  }
  if (any_length)
  {
    plan += (has_costs_ ? "" : std::string("#minimize { 1@3,_A,t : pl(_A,t-1) }.\n")) +
            "#minimize { 1@2,t : busy(t-1) }.\n";
  }
  if (quality_ != PlanQuality::kNone)
  {
    plan += "#minimize { 1@1,_A,t : pl(_A,t-1) }.\n";
  }
  solver_.add("plan", {"t"}, plan);
  solver_.add("query", {"n"}, kQueryRules);
  solver_.add("dear", {"c", "n"}, "dear(c,n) :- #sum { _C,_A,_T : paid(_A,_T,_C), _T < n } > c.\n");
  solver_.add("many", {"c", "n"}, "many(c,n) :- #count { _A,_T : pl(_A,_T), _T < n } > c.\n");
  solver_.add("goal", {"n"}, formulaRules(goal, problem_.description, "goal(n)"));
  const std::string first = std::to_string(now);
  std::string setup = "step(" + first + ".." + std::to_string(now + max_length) + ").\n" +
                      "goal(now) :- goal(" + first + ").\nfails(" + first + ") :- not goal(" +
                      first + ").\n" + (any_length ? "shorter.\n" : "") +
                      "#defined depends/2. #defined open/1. #defined broken/1. #defined tested/1. "
                      "#defined shorter/0. #defined busy/1. #defined paid/3.\n"
                      "#show pl/2. #show paid/3.\n";
  std::vector<Literal> wanted;
  collect(goal, wanted);
  for (const Literal& literal : wanted)
  {
    const std::string term = Encoding::term(literal.atom);
    if (open_index_.count(term) > 0)
    {
      setup += "open(" + term + ").\n";
    }
  }
  solver_.add("setup", {}, setup + dependencies());
  problem_.program.groundHistory(solver_, problem_.records, now, problem_.optimum.assumable);
  HistoryProgram::groundBound(solver_, problem_.optimum.price);
  solver_.ground({{"goal", {now}}, {"setup", {}}});
  searching_ = newGuard();
}

/// `depends(A, F)`: whether A can be executed depends on F.
std::string PlanProgram::dependencies() const
{
  std::string text;
  for (const Executability& rule : problem_.description.executabilities)
  {
    const auto* action = rule.actions.size() == 1 ? std::get_if<Atom>(&rule.actions[0]) : nullptr;
    if (action == nullptr)
    {
      continue;
    }
    for (const Condition& condition : rule.body)
    {
      const auto* literal = std::get_if<Literal>(&condition);
      if (literal != nullptr &&
          problem_.description.findFluent(literal->atom.name)->kind == FluentKind::kInertial)
      {
        Encoding::Guards guards(problem_.description);
        guards.action(*action).fluent(literal->atom);
        text += "depends(" + Encoding::term(*action) + "," + Encoding::term(literal->atom) +
                ") :- open(" + Encoding::term(literal->atom) + ")" + guards.text() + ".\n";
      }
    }
  }
  return text;
}

std::string PlanProgram::costRules() const
{
  std::string text;
  for (const ActionCost& cost : problem_.description.costs)
  {
    Encoding::Guards guards(problem_.description);
    guards.action(cost.action).body(cost.body);
    text += Encoding::comment(cost.position) + "price(" + Encoding::term(cost.action) + ",t-1," +
            std::to_string(std::lround(cost.cost * kMilli)) + ") :- pl(" +
            Encoding::term(cost.action) + ",t-1)" + guards.text() +
            encoding_.body(cost.body, "t-1") + ".\n";
  }
  return text;
}

std::string PlanProgram::literalText(const std::pair<std::string, std::string>& value) const
{
  return toString(toLiteral(open_[open_index_.at(value.first)], value.second));
}

void PlanProgram::extendTo(int length)
{
  while (length_ < length)
  {
    ++length_;
    const int end = problem_.now + length_;
    solver_.ground(
        {{"plan", {end}}, {"trans", {end}}, {"state", {end}}, {"goal", {end}}, {"query", {end}}});
  }
}

// ---- Solving ----

Clingo::literal_t PlanProgram::literal(Clingo::Symbol symbol)
{
  const Clingo::SymbolicAtoms atoms = solver_.control().symbolic_atoms();
  auto found = atoms.find(symbol);
  return found ? found->literal() : 0;  // 0: false in every model
}

/// A literal that is free until it is assumed.
Clingo::literal_t PlanProgram::newGuard()
{
  Clingo::atom_t guard = 0;
  solver_.control().with_backend([&](Clingo::Backend& backend) {
    guard = backend.add_atom();
    backend.external(guard, Clingo::ExternalType::Free);
  });
  return static_cast<Clingo::literal_t>(guard);
}

/// Forbids the literals together while the guard is assumed.
void PlanProgram::addConstraint(Clingo::literal_t guard,
                                const std::vector<Clingo::literal_t>& literals)
{
  std::vector<Clingo::literal_t> body = {guard};
  for (const Clingo::literal_t literal : literals)
  {
    if (literal == 0)
    {
      return;
    }
    body.push_back(literal);
  }
  solver_.control().with_backend([&](Clingo::Backend& backend) {
    backend.rule(false, {}, {body.data(), body.size()});
  });
}

/// Whether there is a model under the assumptions; its shown atoms are then in symbols_.
bool PlanProgram::solve(const Assumptions& assumptions, bool optimize)
{
  if (std::find(assumptions.begin(), assumptions.end(), 0) != assumptions.end())
  {
    return false;
  }
  if (quality_ != PlanQuality::kNone)
  {
    solver_.configure("solve.opt_mode", optimize ? "opt" : "ignore");
    solver_.configure("solve.models", optimize ? "0" : "1");
  }
  auto handle = solver_.control().solve(Clingo::LiteralSpan(assumptions.data(), assumptions.size()),
                                        nullptr, true, true);
  bool found = false;
  for (;;)
  {
    constexpr double kPollSeconds = 0.01;
    while (!handle.wait(kPollSeconds))
    {
      const bool cancelled = limit_.cancel != nullptr && limit_.cancel->load();
      if (cancelled || Clock::now() > limit_.deadline)
      {
        handle.cancel();
        if (cancelled)
        {
          throw Cancelled("planning was cancelled");
        }
        throw DeadlineExceeded("planning took longer than its time limit, at horizon " +
                               std::to_string(length_));
      }
    }
    const Clingo::Model& model = handle.model();
    if (!model)
    {
      return found;
    }
    found = true;
    symbols_ = model.symbols(Clingo::ShowType::Shown);
    if (!optimize)
    {
      return true;
    }
    handle.resume();  // to a better one; the last is the best
  }
}

bool PlanProgram::goalMayBeFalse()
{
  return solve({literal(atom("fails", problem_.now))});
}

bool PlanProgram::isUncovered()
{
  return solve({searching_});
}

std::optional<Proposal> PlanProgram::propose(int length)
{
  return proposal({searching_, literal(atom("query", problem_.now + length))}, length);
}

std::optional<Proposal> PlanProgram::proposal(Assumptions assumptions, int length)
{
  if (!solve(assumptions, quality_ != PlanQuality::kNone))
  {
    return std::nullopt;
  }
  Proposal proposal;
  proposal.steps.resize(static_cast<std::size_t>(length));
  for (const Clingo::Symbol& symbol : symbols_)
  {
    if (symbol.match("pl", 2))
    {
      const int step = symbol.arguments()[1].number() - problem_.now;
      if (step < length)
      {
        proposal.steps[static_cast<std::size_t>(step)].push_back(toText(symbol.arguments()[0]));
        ++proposal.num_actions;
      }
    }
    else if (symbol.match("paid", 3) && symbol.arguments()[1].number() < problem_.now + length)
    {
      proposal.cost_milli += symbol.arguments()[2].number();
    }
  }
  if (!has_costs_)
  {
    proposal.cost_milli = static_cast<long>(kMilli) * static_cast<long>(proposal.num_actions);
  }
  for (auto& actions : proposal.steps)
  {
    std::sort(actions.begin(), actions.end());
  }
  while (!proposal.steps.empty() && proposal.steps.back().empty())
  {
    proposal.steps.pop_back();
  }
  proposal.state = state();
  return proposal;
}

Clingo::literal_t PlanProgram::above(const char* part, long bound, int length)
{
  const int end = problem_.now + length;
  const Clingo::Symbol symbol =
      Clingo::Function(part, {Clingo::Number(static_cast<int>(bound)), Clingo::Number(end)});
  if (literal(symbol) == 0)
  {
    solver_.ground({{part, {static_cast<int>(bound), end}}});
  }
  return literal(symbol);
}

std::optional<Proposal> PlanProgram::proposeAnother(const Proposal& like,
                                                    const OpenValues& hypothesis,
                                                    const std::vector<PlanSteps>& but)
{
  const auto length = static_cast<int>(like.steps.size());
  const Clingo::literal_t guard = newGuard();
  for (const PlanSteps& steps : but)
  {
    std::vector<Clingo::literal_t> occurrences;
    for (const Clingo::literal_t chosen : fixed(steps, steps.size()))
    {
      if (chosen > 0)
      {
        occurrences.push_back(chosen);
      }
    }
    addConstraint(guard, occurrences);
  }
  Assumptions assumptions = {guard, literal(atom("query", problem_.now + length))};
  assume(assumptions, hypothesis);
  if (quality_ != PlanQuality::kNone)
  {
    if (const auto many = above("many", static_cast<long>(like.num_actions), length))
    {
      assumptions.push_back(-many);
    }
  }
  if (has_costs_ && quality_ != PlanQuality::kFewestActions && quality_ != PlanQuality::kNone)
  {
    if (const auto dear = above("dear", like.cost_milli, length))
    {
      assumptions.push_back(-dear);
    }
  }
  std::optional<Proposal> another = proposal(std::move(assumptions), length);
  if (another && another->steps.size() != like.steps.size())
  {
    return std::nullopt;
  }
  return another;
}

OpenValues PlanProgram::state() const
{
  OpenValues values(open_.size());
  for (const Clingo::Symbol& symbol : symbols_)
  {
    if (symbol.match("h", 3) && symbol.arguments()[2].number() == problem_.now)
    {
      const auto found = open_index_.find(symbol.arguments()[0].to_string());
      if (found != open_index_.end())
      {
        values[found->second] = {found->first, toText(symbol.arguments()[1])};
      }
    }
  }
  return values;
}

/// The plan's first steps and nothing else.
PlanProgram::Assumptions PlanProgram::fixed(const PlanSteps& steps, std::size_t upto)
{
  Assumptions assumptions;
  const Clingo::SymbolicAtoms atoms = solver_.control().symbolic_atoms();
  for (auto it = atoms.begin(Clingo::Signature("pl", 2)); it; ++it)
  {
    const auto arguments = it->symbol().arguments();
    const auto step = static_cast<std::size_t>(arguments[1].number() - problem_.now);
    const bool chosen = step < upto && std::binary_search(steps[step].begin(), steps[step].end(),
                                                          toText(arguments[0]));
    assumptions.push_back(chosen ? it->literal() : -it->literal());
  }
  return assumptions;
}

void PlanProgram::assume(Assumptions& assumptions, const OpenValues& values)
{
  for (const auto& [fluent, value] : values)
  {
    assumptions.push_back(literal(holds(fluent, value, problem_.now)));
  }
}

std::optional<OpenValues> PlanProgram::failure(const PlanSteps& steps, const OpenValues& hypothesis)
{
  Assumptions assumptions = fixed(steps, steps.size());
  assumptions.push_back(literal(atom("fails", problem_.now + static_cast<int>(steps.size()))));
  assume(assumptions, hypothesis);
  return solve(assumptions) ? std::optional<OpenValues>(state()) : std::nullopt;
}

std::optional<OpenValues> PlanProgram::dearer(const PlanSteps& steps, const OpenValues& hypothesis,
                                              long cost_milli)
{
  if (!has_costs_)
  {
    return std::nullopt;
  }
  Assumptions assumptions = fixed(steps, steps.size());
  assumptions.push_back(above("dear", cost_milli, static_cast<int>(steps.size())));
  assume(assumptions, hypothesis);
  return solve(assumptions) ? std::optional<OpenValues>(state()) : std::nullopt;
}

long PlanProgram::largestCost(const PlanSteps& steps, const OpenValues& hypothesis, long at_least)
{
  long cost = at_least;
  while (dearer(steps, hypothesis, cost))
  {
    cost = 0;
    for (const Clingo::Symbol& symbol : symbols_)
    {
      const bool within =
          symbol.match("paid", 3) &&
          symbol.arguments()[1].number() < problem_.now + static_cast<int>(steps.size());
      cost += within ? symbol.arguments()[2].number() : 0;
    }
  }
  return cost;
}

std::optional<OpenValues> PlanProgram::stuck(const PlanSteps& steps, std::size_t step,
                                             const OpenValues& hypothesis,
                                             const std::vector<GroundFluent>& fluents)
{
  const int at = problem_.now + static_cast<int>(step);
  std::vector<Clingo::literal_t> atoms;
  std::vector<Clingo::Symbol> symbols;
  for (const GroundFluent& fluent : fluents)
  {
    for (const std::string& value : fluent.values)
    {
      const Clingo::Symbol symbol = holds(Encoding::term(toLiteral(fluent, value).atom), value, at);
      if (const Clingo::literal_t found = literal(symbol))
      {
        atoms.push_back(found);
        symbols.push_back(symbol);
      }
    }
  }
  Assumptions before = fixed(steps, step);
  const Assumptions after = fixed(steps, step + 1);
  assume(before, hypothesis);
  before.push_back(newGuard());
  for (int seen = 0; solve(before); ++seen)
  {
    if (seen == kMaxStates)
    {
      throw ResourceExhausted("a step of a plan depends on more than " +
                              std::to_string(kMaxStates) + " combinations of unknown values");
    }
    const OpenValues found = state();
    const std::set<Clingo::Symbol> shown(symbols_.begin(), symbols_.end());
    std::vector<Clingo::literal_t> there;
    for (std::size_t i = 0; i < atoms.size(); ++i)
    {
      there.push_back(shown.count(symbols[i]) > 0 ? atoms[i] : -atoms[i]);
    }
    Assumptions next = after;
    next.insert(next.end(), there.begin(), there.end());
    if (!solve(next))
    {
      return found;
    }
    addConstraint(before.back(), there);
  }
  return std::nullopt;
}

void PlanProgram::cover(const OpenValues& hypothesis)
{
  Assumptions literals;
  assume(literals, hypothesis);
  addConstraint(searching_, literals);
}

void PlanProgram::forbid(const PlanSteps& steps, int length)
{
  Assumptions literals = fixed(steps, steps.size());
  literals.push_back(literal(atom("query", problem_.now + length)));
  addConstraint(searching_, literals);
}

}  // namespace kr3::reasoner
