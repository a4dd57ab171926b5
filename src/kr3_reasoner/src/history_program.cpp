#include "history_program.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace kr3::reasoner
{

namespace
{

// What holds for every description.
const char* const kClosureRules = R"(
% ---- The closure of what is known initially: founded, apart from the complete state. ----
lit(_F,_V) :- hd(_,_F,_V,_).
lit(_F,_V) :- initn(_F,_V).
c(_F,_V) :- init(_F,_V).
cn(_F,_V) :- initn(_F,_V).
cn(_F,_V) :- lit(_F,_V), c(_F,_W), _W != _V.
c(_F,false) :- cn(_F,true), bool(_F).
c(_F,true) :- cn(_F,false), bool(_F).
:- c(_F,_V), cn(_F,_V).
:- c(_F,_V), c(_F,_W), _V < _W.
% A default fires when its body is in the closure and the contrary of its head is not.
contrary(_D) :- hd(_D,_F,_V,pos), cn(_F,_V).
contrary(_D) :- hd(_D,_F,_V,neg), c(_F,_V).
fires(_D) :- dbody(_D), not contrary(_D), free(_D,_B) : better(_B,_D).
c(_F,_V) :- fires(_D), hd(_D,_F,_V,pos).
cn(_F,_V) :- fires(_D), hd(_D,_F,_V,neg).
% Exceptions: contraries of heads may be assumed.
abducible(no(_F,_V)) :- hd(_D,_F,_V,pos), not off(_D).
abducible(yes(_F,_V)) :- hd(_D,_F,_V,neg), not off(_D).
cn(_F,_V) :- ab(no(_F,_V)).
c(_F,_V) :- ab(yes(_F,_V)).
#defined free/2. #defined init/2. #defined initn/2. #defined hd/4. #defined dbody/1. #defined better/2. #defined bool/1.
#defined weight/2. #defined doubt/2. #defined c/2. #defined cn/2. #defined lit/2. #defined price/2. #defined off/1.
)";

const char* const kInitialStateRules = R"(
{ ab(_X) } :- abducible(_X).
% The initial state is any complete state that contains the closure.
1 { h(_F,_V,0) : fv(_F,_V) } 1 :- basic(_F).
:- c(_F,_V), basic(_F), not h(_F,_V,0).
:- cn(_F,_V), h(_F,_V,0).
:- c(_F,true), defined(_F), not h(_F,true,0).
:- c(_F,false), defined(_F), h(_F,true,0).
#show h/3. #show ab/1. #show st/2.
)";

// free(D, B): the better default B does not keep D from firing. That B is out because the contrary
// of its head is known must be founded: what D itself concludes cannot be the reason. k, kn: what
// is known without defaults. x, xn: what follows on a layer, from the heads of one default or of
// two.
const char* const kPriorityRules = R"(
% ---- Preferences ----
free(_D,_B) :- better(_B,_D), not exclude(_B,_D).
free(_D,_B) :- better(_B,_D), not dbody(_B).
free(_D,_B) :- better(_B,_D), contrary(_B).
free(_D,_B) :- better(_B,_D), blocked(_B).
blocked(_D) :- better(_B,_D), not free(_D,_B).
k(_F,_V) :- init(_F,_V).
k(_F,_V) :- ab(yes(_F,_V)).
kn(_F,_V) :- initn(_F,_V).
kn(_F,_V) :- ab(no(_F,_V)).
kn(_F,_V) :- lit(_F,_V), k(_F,_W), _W != _V.
k(_F,false) :- kn(_F,true), bool(_F).
k(_F,true) :- kn(_F,false), bool(_F).
% Two heads exclude each other when each agrees with what is known without defaults, but not both.
exclude(_B,_D) :- clash(two(_B,_D)), not clash(one(_B)), not clash(one(_D)).
head(one(_B),_B) :- better(_B,_).
head(one(_D),_D) :- better(_,_D).
head(two(_B,_D),(_B;_D)) :- better(_B,_D).
x(_L,_F,_V) :- head(_L,_D), hd(_D,_F,_V,pos).
xn(_L,_F,_V) :- head(_L,_D), hd(_D,_F,_V,neg).
xn(_L,_F,_V) :- x(_L,_F,_W), lit(_F,_V), _W != _V.
x(_L,_F,false) :- xn(_L,_F,true), bool(_F).
x(_L,_F,true) :- xn(_L,_F,false), bool(_F).
about(_L,_F) :- x(_L,_F,_).
about(_L,_F) :- xn(_L,_F,_).
y(_L,_F,_V) :- x(_L,_F,_V).
y(_L,_F,_V) :- beside(_L,_F), k(_F,_V).
yn(_L,_F,_V) :- xn(_L,_F,_V).
yn(_L,_F,_V) :- beside(_L,_F), kn(_F,_V).
beside(_L,_F) :- about(_L,_F).
clash(_L) :- x(_L,_F,_V), yn(_L,_F,_V).
clash(_L) :- xn(_L,_F,_V), y(_L,_F,_V).
clash(_L) :- x(_L,_F,_V), y(_L,_F,_W), _V != _W.
#defined k/2. #defined kn/2. #defined x/3. #defined xn/3. #defined y/3. #defined yn/3.
)";

const char* const kExogenousRules = R"(
abducible(exo(_A,_t-1)) :- exog(_A).
occ(_A,_t-1) :- ab(exo(_A,_t-1)).
)";

const char* const kMinimizeRules = R"(
#minimize { _W@2,_X : ab(_X), doubt(_X,_W) }.
#minimize { _W@1,_X : ab(_X), weight(_X,_W) }.
)";

const char* const kBoundRules = R"(
:- #sum { _W,_X : ab(_X), doubt(_X,_W) } > r.
:- #sum { _W,_X : ab(_X), weight(_X,_W) } > a.
)";

std::string variableTuple(const Encoding::Guards& guards)
{
  std::string text;
  for (const std::string& variable : guards.variables())
  {
    text += variable + ",";
  }
  return "(" + text + ")";
}

}  // namespace

HistoryProgram::HistoryProgram(const Description& description, const ReasonerOptions& options,
                               std::shared_ptr<const Beginning> beginning)
  : description_(description)
  , options_(options)
  , encoding_(description)
  , beginning_(std::move(beginning))
  , grounded_(std::make_shared<Grounded>())
{
}

HistoryProgram HistoryProgram::beginningAt(std::shared_ptr<const Beginning> beginning) const
{
  HistoryProgram program = *this;
  program.beginning_ = std::move(beginning);
  return program;
}

Dynamics& HistoryProgram::dynamics(bool exogenous) const
{
  std::unique_ptr<Dynamics>& kept = exogenous ? grounded_->exogenous_dynamics : grounded_->dynamics;
  if (!kept)
  {
    kept = std::make_unique<Dynamics>(description_, exogenous, limit());
  }
  return *kept;
}

std::shared_ptr<Closure> HistoryProgram::closureFor(const std::vector<CheckedRecord>& records) const
{
  std::vector<std::string> statements;
  std::set<std::string> seen;
  for (const CheckedRecord& record : records)
  {
    const std::string statement = initialStatement(record);
    if (!statement.empty() && seen.insert(statement).second)
    {
      statements.push_back(statement);
    }
  }
  std::shared_ptr<Closure>& kept = grounded_->closure;
  if (!kept || !kept->covers(statements))
  {
    kept = std::make_shared<Closure>(encoding_.vocabulary() + closure(), std::move(statements),
                                     limit());
  }
  return kept;
}

std::string HistoryProgram::initialStatement(const CheckedRecord& record) const
{
  const Literal& literal = record.literal;
  if (record.isAction() || record.record.step != 0 ||
      description_.findFluent(literal.atom.name)->kind == FluentKind::kStatic)
  {
    return "";
  }
  return (literal.equal ? "init(" : "initn(") + Encoding::term(literal.atom) + "," +
         literal.value.name + ")";
}

std::string HistoryProgram::closureLiteral(const Literal& open, const std::string& layer) const
{
  const Literal literal = normalized(open, description_);
  const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
  if (fluent.kind == FluentKind::kStatic)
  {
    return encoding_.literal(literal, "0");
  }
  return layer + (literal.equal ? "(" : "n(") + Encoding::term(literal.atom) + "," +
         literal.value.name + ")";
}

std::string HistoryProgram::closureBody(const Body& body, const std::string& layer) const
{
  std::string text;
  for (const Condition& condition : body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    text += literal != nullptr ? ", " + closureLiteral(*literal, layer)
                               : encoding_.body({condition}, "0");
  }
  return text;
}

std::string HistoryProgram::defaultRules(const Default& rule) const
{
  Encoding::Guards guards(description_);
  guards.literal(rule.head).body(rule.body);
  const std::string id = "d(" + Encoding::term(rule.name) + "," + variableTuple(guards) + ")";
  const Literal head = normalized(rule.head, description_);
  const std::string head_text = Encoding::term(head.atom) + "," + head.value.name;
  Body fixed;  // what the history cannot change
  std::string mentioned;
  for (const Condition& condition : rule.body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    if (literal == nullptr ||
        description_.findFluent(literal->atom.name)->kind == FluentKind::kStatic)
    {
      fixed.push_back(condition);
    }
    else if (!normalized(*literal, description_).equal)
    {
      mentioned += "lit(" + Encoding::term(literal->atom) + "," + literal->value.name +
                   ") :- #true" + guards.text() + ".\n";
    }
  }
  std::string text = Encoding::comment(rule.position);
  text += "hd(" + id + "," + head_text + (head.equal ? ",pos)" : ",neg)") + " :- #true" +
          guards.text() + encoding_.body(fixed, "0") + ".\n" + mentioned;
  text += "dbody(" + id + ") :- #true" + guards.text() + closureBody(rule.body, "c") +
          ", not off(" + id + ").\n";
  const auto weight = options_.default_weights.find(rule.name.name);
  const int price =
      weight == options_.default_weights.end() ? options_.exception_weight : weight->second;
  text += "price(" + std::string(head.equal ? "no(" : "yes(") + head_text + ")," +
          std::to_string(price) + ") :- #true" + guards.text() + encoding_.body(fixed, "0") + ".\n";
  return text;
}

std::string HistoryProgram::constraintRules(const StateConstraint& constraint,
                                            const std::string& layer) const
{
  if (!constraint.head ||
      description_.findFluent(constraint.head->atom.name)->kind == FluentKind::kStatic)
  {
    return "";  // the complete state satisfies it anyway
  }
  Encoding::Guards guards(description_);
  guards.literal(*constraint.head).body(constraint.body);
  std::string text = Encoding::comment(constraint.position);
  for (const Condition& condition : constraint.body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    if (literal != nullptr && !normalized(*literal, description_).equal &&
        description_.findFluent(literal->atom.name)->kind != FluentKind::kStatic)
    {
      text += "lit(" + Encoding::term(literal->atom) + "," + literal->value.name + ") :- #true" +
              guards.text() + ".\n";
    }
  }
  return text + closureLiteral(*constraint.head, layer) + " :- #true" + guards.text() +
         closureBody(constraint.body, layer) + ".\n";
}

std::string HistoryProgram::exclusionRules(const StateConstraint& constraint) const
{
  Body fixed;
  std::vector<Literal> literals;
  for (const Condition& condition : constraint.body)
  {
    const auto* literal = std::get_if<Literal>(&condition);
    if (literal == nullptr ||
        description_.findFluent(literal->atom.name)->kind == FluentKind::kStatic)
    {
      fixed.push_back(condition);
    }
    else
    {
      literals.push_back(normalized(*literal, description_));
    }
  }
  if (constraint.head &&
      description_.findFluent(constraint.head->atom.name)->kind == FluentKind::kStatic)
  {
    return "";
  }
  Encoding::Guards guards(description_);
  guards.body(constraint.body);
  if (constraint.head)
  {
    guards.literal(*constraint.head);
  }
  const std::string conditions = guards.text() + encoding_.body(fixed, "0");
  const auto on = [&](const Literal& literal, const std::string& layer) {
    return layer + (literal.equal ? "(_L," : "n(_L,") + Encoding::term(literal.atom) + "," +
           literal.value.name + ")";
  };
  const std::string head =
      constraint.head ? on(normalized(*constraint.head, description_), "x") : "clash(_L)";
  // What the heads do not touch is known without them; so at least one literal is theirs.
  std::string text = Encoding::comment(constraint.position);
  for (std::size_t i = 0; i < literals.size(); ++i)
  {
    std::string others;
    for (std::size_t j = 0; j < literals.size(); ++j)
    {
      if (j != i)
      {
        others += ", " + on(literals[j], "y");
        text += "beside(_L," + Encoding::term(literals[j].atom) + ") :- about(_L," +
                Encoding::term(literals[i].atom) + ")" + conditions + ".\n";
      }
    }
    text += head + " :- " + on(literals[i], "x") + others + conditions + ".\n";
    if (!literals[i].equal)
    {
      text += "lit(" + Encoding::term(literals[i].atom) + "," + literals[i].value.name +
              ") :- #true" + guards.text() + ".\n";
    }
  }
  return text;
}

std::string HistoryProgram::preferenceRules() const
{
  std::string text;
  for (const Preference& preference : description_.preferences)
  {
    text += Encoding::comment(preference.position) + "better(d(" +
            Encoding::term(preference.better) + ",_B),d(" + Encoding::term(preference.worse) +
            ",_W)) :- hd(d(" + Encoding::term(preference.better) + ",_B),_,_,_), hd(d(" +
            Encoding::term(preference.worse) + ",_W),_,_,_).\n";
  }
  return text + "better(_A,_C) :- better(_A,_B), better(_B,_C).\n";
}

std::string HistoryProgram::closure() const
{
  std::string text = kClosureRules;
  for (const FluentDeclaration& fluent : description_.fluents)
  {
    if (!fluent.value_sort && fluent.kind != FluentKind::kStatic)
    {
      std::string arguments;
      for (std::size_t i = 0; i < fluent.argument_sorts.size(); ++i)
      {
        arguments += (i == 0 ? "(_" : ",_");
      }
      const std::string term = fluent.name + (arguments.empty() ? "" : arguments + ")");
      text += "bool(_F) :- basic(_F), _F = " + term + ".\nbool(_F) :- defined(_F), _F = " + term +
              ".\n";
    }
  }
  for (const Default& rule : description_.defaults)
  {
    text += defaultRules(rule);
  }
  for (const StateConstraint& constraint : description_.constraints)
  {
    text += constraintRules(constraint, "c");
  }
  if (!description_.preferences.empty())
  {
    text += kPriorityRules + preferenceRules();
    for (const StateConstraint& constraint : description_.constraints)
    {
      text += constraintRules(constraint, "k") + exclusionRules(constraint);
    }
  }
  text +=
      "weight(_X,_P) :- abducible(_X), _P = #min { _Q : price(_X,_Q) }, price(_X,_).\n#defined "
      "price/2.\n";
  return text + weightRules();
}

/// Prices of what is assumed besides exceptions.
std::string HistoryProgram::weightRules() const
{
  const std::string weight = std::to_string(options_.exogenous_weight);
  return "weight(exo(_A,_I)," + weight + ") :- abducible(exo(_A,_I)).\n" + "weight(fail(_A,_I)," +
         weight + ") :- abducible(fail(_A,_I)), not imp(_A,_I).\n";
}

std::string HistoryProgram::initialRules() const
{
  if (!beginning_)
  {
    return closure() + kInitialStateRules;
  }
  return "\n% ---- The history was progressed: it begins at a later step. ----\n" + weightRules() +
         "{ ab(_X) } :- abducible(_X).\n1 { h(_F,_V," + std::to_string(firstStep()) +
         ") : fv(_F,_V) } 1 :- basic(_F).\n#show h/3. #show ab/1. #show st/2.\n"
         "#defined ab/1. #defined abducible/1. #defined weight/2. #defined doubt/2. #defined "
         "hd/4. #defined c/2. #defined cn/2.\n";
}

/// What is known of the first step.
std::string HistoryProgram::beginningRules(const Assumable& assumable, bool switchable) const
{
  if (!beginning_)
  {
    return "";
  }
  std::string text = (switchable ? "#external begun.\n" : "begun.\n") + factRules(*beginning_);
  if (!switchable)
  {
    return text + levelRules(beginning_->level(assumable), indexOf(assumable), "", firstStep());
  }
  for (const bool exogenous : {false, true})
  {
    const std::string guard = exogenous ? "allowed(exogenous)" : "not allowed(exogenous)";
    const bool alike =
        &beginning_->level({exogenous, true}) == &beginning_->level({exogenous, false});
    for (const bool retractions : {false, true})
    {
      const Assumable kinds{exogenous, retractions};
      if (alike && retractions)
      {
        continue;
      }
      text += levelRules(beginning_->level(kinds), indexOf(kinds),
                         guard + (alike         ? ""
                                  : retractions ? ", allowed(retraction)"
                                                : ", not allowed(retraction)"),
                         firstStep());
    }
  }
  return text;
}

std::string HistoryProgram::recordRules(const std::vector<CheckedRecord>& records,
                                        const Assumable& assumable, bool switchable) const
{
  std::string text;
  for (std::size_t i = 0; i < records.size(); ++i)
  {
    const CheckedRecord& checked = records[i];
    const std::string number = std::to_string(i);
    const std::string step = std::to_string(checked.record.step);
    text += Encoding::comment(checked.record.position) + "% " + toString(checked.record) + "\n" +
            (switchable ? "#external rec(" : "rec(") + number + ").\n";
    if (checked.isAction())
    {
      const std::string action = Encoding::term(checked.action);
      const std::string failed = "fail(" + action + "," + step + ")";
      const bool attempt = checked.record.kind == RecordKind::kAttempted;
      text += "occ(" + action + "," + step + ") :- rec(" + number + ")" +
              (attempt ? ", not ab(" + failed + ").\nabducible(" + failed + ") :- rec(" + number +
                             ").\n"
                       : ".\n");
      continue;
    }
    std::string holds = "rec(" + number + ")";
    if (assumable.retractions && checked.record.confidence < 1.0)
    {
      text += "abducible(wrong(" + number + ")). doubt(wrong(" + number + ")," +
              std::to_string(doubtOf(checked.record)) + ").\n";
      holds += ", not ab(wrong(" + number + "))";
    }
    const Literal& literal = checked.literal;
    const std::string pair = Encoding::term(literal.atom) + "," + literal.value.name;
    const FluentDeclaration& fluent = *description_.findFluent(literal.atom.name);
    const std::string initial = initialStatement(checked);
    if (!initial.empty())
    {
      text += initial + " :- " + holds + ".\n";
    }
    if (fluent.kind == FluentKind::kDefined)
    {
      const bool positive = literal.value.name == "true";
      text += ":- " + holds + (positive ? ", not h(" : ", h(") + Encoding::term(literal.atom) +
              ",true," + step + ").\n";
    }
    else if (fluent.kind == FluentKind::kStatic)
    {
      text += "said(" + number + ") :- " + encoding_.literal(literal, step) + ".\n:- " + holds +
              ", not said(" + number + ").\n";
    }
    else
    {
      text += ":- " + holds + (literal.equal ? ", not h(" : ", h(") + pair + "," + step + ").\n";
    }
  }
  return text + "#defined rec/1. #defined said/1.\n" + beginningRules(assumable, switchable);
}

void HistoryProgram::addTo(Solver& solver) const
{
  solver.add("base", {}, encoding_.signature() + initialRules());
  solver.add("state", {"_t"}, encoding_.state());
  solver.add("trans", {"_t"}, encoding_.transition());
  solver.add("exo", {"_t"}, kExogenousRules);
  solver.add("minimize", {}, kMinimizeRules);
  solver.add("bound", {"r", "a"}, kBoundRules);
}

void HistoryProgram::groundHistory(Solver& solver, const std::vector<CheckedRecord>& records,
                                   int current_step, const Assumable& assumable,
                                   bool switchable) const
{
  solver.add("records", {}, recordRules(records, assumable, switchable));
  std::vector<Solver::Part> parts = {{"base", {}}, {"state", {firstStep()}}, {"records", {}}};
  for (int step = firstStep() + 1; step <= current_step; ++step)
  {
    parts.push_back({"trans", {step}});
    parts.push_back({"state", {step}});
    if (assumable.exogenous)
    {
      parts.push_back({"exo", {step}});
    }
  }
  solver.ground(parts);
}

void HistoryProgram::groundBound(Solver& solver, const Price& price)
{
  solver.ground({{"bound", {price.retractions, price.assumptions}}});
}

std::string HistoryProgram::text(const std::vector<CheckedRecord>& records,
                                 const Assumable& assumable) const
{
  return "#program base.\n" + encoding_.signature() + initialRules() + "\n#program state(_t).\n" +
         encoding_.state() + "\n#program trans(_t).\n" + encoding_.transition() +
         "\n#program exo(_t).\n" + kExogenousRules + "\n#program minimize.\n" + kMinimizeRules +
         "\n#program bound(r,a).\n" + kBoundRules + "\n#program records.\n" +
         recordRules(records, assumable, false);
}

}  // namespace kr3::reasoner
