#include "planner.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

#include "ground_fluents.hpp"

namespace kr3::reasoner
{

namespace
{

using Clock = std::chrono::steady_clock;

// `pl(A, t)`: the plan has A at t. It occurs unless an earlier action turned out impossible.
const char* const kPlanRules = R"(
{ pl(_A,t-1) : agent(_A) }.
occ(_A,t-1) :- pl(_A,t-1), not broken(t-1).
broken(t-1) :- pl(_A,t-1), imp(_A,t-1).
broken(t-1) :- broken(t-2).
busy(t-1) :- pl(_A,t-1).
tested(t) :- pl(_A,t-1), depends(_A,_F), open(_F).
tested(t) :- tested(t-1).
)";

// What the plan of length n must do in the model where it is looked for.
const char* const kQueryRules = R"(
#external query(n).
fails(n) :- not goal(n).
fails(n) :- broken(n-1).
:- query(n), fails(n).
:- query(n), step(_T), _T < n, not busy(_T).
:- query(n), goal(now), not tested(n).
)";

double cpuSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Clingo::Symbol holds(const std::string& fluent, const std::string& value, int step)
{
  return Clingo::Function("h", {Clingo::parse_term(fluent.c_str()),
                                Clingo::parse_term(value.c_str()), Clingo::Number(step)});
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

}  // namespace

/// One search: its solver holds the history, the plan and the goal at growing horizons.
class Planner::Search
{
public:
  Search(const Planner& planner, const Formula& goal, const PlanOptions& options,
         const std::atomic<bool>* cancel)
    : planner_(planner)
    , goal_(goal)
    , cancel_(cancel)
    , deadline_(Clock::now() + options.time_limit)
    , max_horizon_(options.max_horizon)
    , on_horizon_(options.on_horizon)
    , encoding_(planner.description_)
    , solver_({"1", "--warn=none"})
    , now_(planner.current_step_)
  {
    findOpenFluents();
    buildProgram();
  }

  PlanResult run()
  {
    PlanResult result;
    if (!solve({literal("fails", now_)}))
    {
      result.goal_entailed = true;
      return result;
    }
    for (int length = 1; length <= max_horizon_ && uncovered(); ++length)
    {
      if (on_horizon_)
      {
        on_horizon_(length);
      }
      const int end = now_ + length;
      extendTo(end);
      solver_.control().assign_external(atom("query", end), Clingo::TruthValue::True);
      while (solve({literal("searching")}))
      {
        const std::vector<std::vector<std::string>> steps = planOf(symbols_, end);
        const std::vector<std::pair<std::string, std::string>> state = stateOf(symbols_);
        solver_.control().assign_external(atom("query", end), Clingo::TruthValue::False);
        std::optional<std::vector<std::size_t>> hypothesis = hypothesisOf(steps, state, end);
        solver_.control().assign_external(atom("query", end), Clingo::TruthValue::True);
        if (!hypothesis)
        {
          forbid(steps);
          continue;
        }
        Plan plan;
        plan.steps = steps;
        for (const std::size_t index : *hypothesis)
        {
          plan.hypothesis.push_back(literalText(state[index]));
        }
        result.plans.push_back(std::move(plan));
        cover(*hypothesis, state);
      }
      solver_.control().assign_external(atom("query", end), Clingo::TruthValue::False);
    }
    if (result.plans.empty())
    {
      result.reason = reasonForNone();
    }
    return result;
  }

private:
  using Assumptions = std::vector<Clingo::literal_t>;
  using Values =
      std::vector<std::pair<std::string, std::string>>;  // of the open fluents, in their order

  // ---- Building ----

  void findOpenFluents()
  {
    for (const GroundFluent& fluent : groundFluents(planner_.description_))
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
        possible += planner_.consequences_.inSome(value, now_) ? 1 : 0;
      }
      if (possible > 1)
      {
        open_index_.emplace(Encoding::term(value.atom), open_.size());
        open_.push_back(fluent);
      }
    }
  }

  [[nodiscard]] static Literal toLiteral(const GroundFluent& fluent, const std::string& value)
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

  /// The atom that stands for a formula; its rules are added to `rules`.
  std::string formulaRules(const Formula& formula, std::string& rules)
  {
    if (formula.kind == Formula::Kind::kLiteral)
    {
      const std::string name = "part(" + std::to_string(num_parts_++) + ",n)";
      rules += name + " :- " +
               encoding_.literal(normalized(formula.literal, planner_.description_), "n") + ".\n";
      return name;
    }
    std::vector<std::string> operands;
    for (const Formula& operand : formula.operands)
    {
      operands.push_back(formulaRules(operand, rules));
    }
    const std::string name = "part(" + std::to_string(num_parts_++) + ",n)";
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

  void buildProgram()
  {
    planner_.program_.addTo(solver_);
    solver_.add("plan", {"t"}, kPlanRules);
    solver_.add("query", {"n"}, kQueryRules);
    std::string rules;
    const std::string root = formulaRules(goal_, rules);
    solver_.add("goal", {"n"}, rules + "goal(n) :- " + root + ".\n");
    std::string setup =
        "#external searching.\nstep(" + std::to_string(now_) + ".." +
        std::to_string(now_ + max_horizon_) + ").\n" + "goal(now) :- goal(" + std::to_string(now_) +
        ").\nfails(" + std::to_string(now_) + ") :- not goal(" + std::to_string(now_) + ").\n" +
        "#defined depends/2. #defined open/1. #defined broken/1. #defined tested/1.\n" +
        "#show pl/2.\n";
    std::vector<Literal> wanted;
    collect(goal_, wanted);
    for (const Literal& literal : wanted)
    {
      const std::string term = Encoding::term(literal.atom);
      if (open_index_.count(term) > 0)
      {
        setup += "open(" + term + ").\n";
      }
    }
    solver_.add("setup", {}, setup + dependencies());
    planner_.program_.groundHistory(solver_, planner_.records_, now_, planner_.optimum_.assumable);
    HistoryProgram::groundBound(solver_, planner_.optimum_.price);
    solver_.ground({{"goal", {now_}}, {"setup", {}}});
  }

  /// `depends(A, F)`: whether A can be executed depends on F.
  [[nodiscard]] std::string dependencies() const
  {
    std::string text;
    for (const Executability& rule : planner_.description_.executabilities)
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
            planner_.description_.findFluent(literal->atom.name)->kind == FluentKind::kInertial)
        {
          Encoding::Guards guards(planner_.description_);
          guards.action(*action).fluent(literal->atom);
          text += "depends(" + Encoding::term(*action) + "," + Encoding::term(literal->atom) +
                  ") :- open(" + Encoding::term(literal->atom) + ")" + guards.text() + ".\n";
        }
      }
    }
    return text;
  }

  void extendTo(int end)
  {
    solver_.ground(
        {{"plan", {end}}, {"trans", {end}}, {"state", {end}}, {"goal", {end}}, {"query", {end}}});
    horizon_ = end;
  }

  // ---- Solving ----

  static Clingo::Symbol atom(const char* name, int step)
  {
    return Clingo::Function(name, {Clingo::Number(step)});
  }

  Clingo::literal_t literal(Clingo::Symbol symbol)
  {
    const Clingo::SymbolicAtoms atoms = solver_.control().symbolic_atoms();
    auto found = atoms.find(symbol);
    return found ? found->literal() : 0;  // 0: false in every model
  }
  Clingo::literal_t literal(const char* name, int step) { return literal(atom(name, step)); }
  Clingo::literal_t literal(const char* name) { return literal(Clingo::Id(name)); }

  /// Whether there is a model under the assumptions; its shown atoms are then in symbols_.
  bool solve(Assumptions assumptions)
  {
    for (const Clingo::literal_t assumed : assumptions)
    {
      if (assumed == 0)
      {
        return false;
      }
    }
    const bool searching = !assumptions.empty() && assumptions.front() == literal("searching");
    solver_.control().assign_external(
        Clingo::Id("searching"), searching ? Clingo::TruthValue::True : Clingo::TruthValue::False);
    if (searching)
    {
      assumptions.erase(assumptions.begin());
    }
    auto handle = solver_.control().solve(
        Clingo::LiteralSpan(assumptions.data(), assumptions.size()), nullptr, true, true);
    constexpr double kPollSeconds = 0.01;
    while (!handle.wait(kPollSeconds))
    {
      const bool cancelled = cancel_ != nullptr && cancel_->load();
      if (cancelled || Clock::now() > deadline_)
      {
        handle.cancel();
        if (cancelled)
        {
          throw Cancelled("planning was cancelled");
        }
        throw DeadlineExceeded("planning took longer than its time limit, at horizon " +
                               std::to_string(horizon_ - now_));
      }
    }
    const Clingo::Model& model = handle.model();
    if (!model)
    {
      return false;
    }
    symbols_ = model.symbols(Clingo::ShowType::Shown);
    return true;
  }

  bool uncovered() { return solve({literal("searching")}); }

  // ---- Reading models ----

  [[nodiscard]] std::vector<std::vector<std::string>> planOf(const Clingo::SymbolVector& symbols,
                                                             int end) const
  {
    std::vector<std::vector<std::string>> steps(static_cast<std::size_t>(end - now_));
    for (const Clingo::Symbol& symbol : symbols)
    {
      if (symbol.match("pl", 2))
      {
        steps[static_cast<std::size_t>(symbol.arguments()[1].number() - now_)].push_back(
            toText(symbol.arguments()[0]));
      }
    }
    for (auto& actions : steps)
    {
      std::sort(actions.begin(), actions.end());
    }
    return steps;
  }

  [[nodiscard]] Values stateOf(const Clingo::SymbolVector& symbols) const
  {
    Values values(open_.size());
    for (const Clingo::Symbol& symbol : symbols)
    {
      if (symbol.match("h", 3) && symbol.arguments()[2].number() == now_)
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

  [[nodiscard]] std::string literalText(const std::pair<std::string, std::string>& value) const
  {
    return toString(toLiteral(open_[open_index_.at(value.first)], value.second));
  }

  // ---- Hypotheses ----

  /// The plan fixed, and it failing: satisfied by counterexamples.
  Assumptions failureOf(const std::vector<std::vector<std::string>>& steps, int end)
  {
    Assumptions assumptions = {literal("fails", end)};
    std::set<std::string> planned;
    for (std::size_t i = 0; i < steps.size(); ++i)
    {
      for (const std::string& action : steps[i])
      {
        planned.insert(std::to_string(now_ + static_cast<int>(i)) + action);
      }
    }
    const Clingo::SymbolicAtoms atoms = solver_.control().symbolic_atoms();
    for (auto it = atoms.begin(Clingo::Signature("pl", 2)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      const bool chosen =
          planned.count(std::to_string(arguments[1].number()) + toText(arguments[0])) > 0;
      assumptions.push_back(chosen ? it->literal() : -it->literal());
    }
    return assumptions;
  }

  bool failsUnder(Assumptions assumptions, const std::vector<std::size_t>& hypothesis,
                  const Values& state)
  {
    for (const std::size_t index : hypothesis)
    {
      assumptions.push_back(literal(holds(state[index].first, state[index].second, now_)));
    }
    return solve(std::move(assumptions));
  }

  /// Open fluents (indices) whose values in `state` make the plan work in every model that agrees
  /// with them; nothing when it can fail whatever is assumed.
  std::optional<std::vector<std::size_t>> hypothesisOf(
      const std::vector<std::vector<std::string>>& steps, const Values& state, int end)
  {
    const Assumptions failure = failureOf(steps, end);
    std::vector<std::size_t> hypothesis;
    while (failsUnder(failure, hypothesis, state))
    {
      const Values counterexample = stateOf(symbols_);
      const std::size_t before = hypothesis.size();
      for (std::size_t i = 0; i < state.size(); ++i)
      {
        if (state[i].second != counterexample[i].second)
        {
          hypothesis.push_back(i);
        }
      }
      if (hypothesis.size() == before)
      {
        return std::nullopt;
      }
    }
    for (std::size_t i = 0; i < hypothesis.size();)
    {
      std::vector<std::size_t> shorter = hypothesis;
      shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(i));
      if (failsUnder(failure, shorter, state))
      {
        ++i;
      }
      else
      {
        hypothesis = std::move(shorter);
      }
    }
    std::sort(hypothesis.begin(), hypothesis.end());
    return hypothesis;
  }

  /// Leaves the models of a hypothesis out of further searches.
  void cover(const std::vector<std::size_t>& hypothesis, const Values& state)
  {
    std::string body;
    for (const std::size_t index : hypothesis)
    {
      body += ", h(" + state[index].first + "," + state[index].second + "," + std::to_string(now_) +
              ")";
    }
    addConstraint(body);
  }

  /// Leaves a plan that can fail out of further searches.
  void forbid(const std::vector<std::vector<std::string>>& steps)
  {
    std::string body;
    for (std::size_t i = 0; i < steps.size(); ++i)
    {
      for (const std::string& action : steps[i])
      {
        body += ", pl(" + action + "," + std::to_string(now_ + static_cast<int>(i)) + ")";
      }
    }
    addConstraint(body);
  }

  void addConstraint(const std::string& body)
  {
    const std::string part = "extra" + std::to_string(num_extra_++);
    solver_.add(part, {}, ":- searching" + body + ".\n");
    solver_.ground({{part, {}}});
  }

  // ---- No plan ----

  std::string reasonForNone()
  {
    Solver any({"1", "--warn=none"});
    any.add("base", {}, encoding_.signature() + Encoding::anyState());
    any.add("state", {"t"}, encoding_.state());
    std::string rules;
    num_parts_ = 0;
    const std::string root = formulaRules(goal_, rules);
    any.add("goal", {"n"}, rules + ":- not " + root + ".\n");
    any.ground({{"base", {}}, {"state", {0}}, {"goal", {0}}});
    if (!any.control().solve().get().is_satisfiable())
    {
      return "no state of the domain satisfies the goal " + toString(goal_);
    }
    return "no plan of at most " + std::to_string(max_horizon_) + " steps reaches the goal " +
           toString(goal_);
  }

  const Planner& planner_;
  const Formula& goal_;
  const std::atomic<bool>* cancel_;
  Clock::time_point deadline_;
  int max_horizon_;
  std::function<void(int)> on_horizon_;
  Encoding encoding_;
  Solver solver_;
  int now_;
  int horizon_ = now_;
  int num_parts_ = 0;
  int num_extra_ = 0;
  std::vector<GroundFluent> open_;
  std::unordered_map<std::string, std::size_t> open_index_;
  Clingo::SymbolVector symbols_;
};

Planner::Planner(const Description& description, const HistoryProgram& program,
                 const std::vector<CheckedRecord>& records, int current_step,
                 const Optimum& optimum, const Consequences& consequences)
  : description_(description)
  , program_(program)
  , records_(records)
  , current_step_(current_step)
  , optimum_(optimum)
  , consequences_(consequences)
{
}

PlanResult Planner::plan(const Formula& goal, const PlanOptions& options,
                         const std::atomic<bool>* cancel) const
{
  if (options.max_horizon < 1)
  {
    throw InvalidArgument("found max_horizon " + std::to_string(options.max_horizon) +
                          ", expected at least 1");
  }
  const double start = cpuSeconds();
  PlanResult result = Search(*this, goal, options, cancel).run();
  result.cpu_s = cpuSeconds() - start;
  return result;
}

}  // namespace kr3::reasoner
