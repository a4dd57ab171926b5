#include "history_program.hpp"

#include <algorithm>
#include <cmath>

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
:- basic(_F), 2 { c(_F,_V) : fv(_F,_V) }.
% A default fires when its body is in the closure and the contrary of its head is not.
contrary(_D) :- hd(_D,_F,_V,pos), cn(_F,_V).
contrary(_D) :- hd(_D,_F,_V,neg), c(_F,_V).
fires(_D) :- dbody(_D), not contrary(_D).
c(_F,_V) :- fires(_D), hd(_D,_F,_V,pos), not blocked(_D).
cn(_F,_V) :- fires(_D), hd(_D,_F,_V,neg), not blocked(_D).
% Exceptions: contraries of heads may be assumed.
abducible(no(_F,_V)) :- hd(_,_F,_V,pos).
abducible(yes(_F,_V)) :- hd(_,_F,_V,neg).
cn(_F,_V) :- ab(no(_F,_V)).
c(_F,_V) :- ab(yes(_F,_V)).
{ ab(_X) } :- abducible(_X).
% The initial state is any complete state that contains the closure.
1 { h(_F,_V,0) : fv(_F,_V) } 1 :- basic(_F).
:- c(_F,_V), basic(_F), not h(_F,_V,0).
:- cn(_F,_V), h(_F,_V,0).
:- c(_F,true), defined(_F), not h(_F,true,0).
:- c(_F,false), defined(_F), h(_F,true,0).
#defined blocked/1. #defined init/2. #defined initn/2. #defined hd/4. #defined dbody/1. #defined better/2. #defined bool/1.
#defined weight/2. #defined doubt/2. #defined c/2. #defined cn/2. #defined lit/2.
#show h/3. #show ab/1. #show st/2.
)";

// A default is blocked while a better one with an exclusive head fires. What the worse one
// concludes must not be what keeps the better one from firing: k, kn is what is known without
// defaults.
const char* const kPriorityRules = R"(
% ---- Preferences ----
exclude(_A,_B) :- hd(_A,_F,_V,pos), hd(_B,_F,_U,pos), _U != _V.
exclude(_A,_B) :- hd(_A,_F,_V,pos), hd(_B,_F,_V,neg).
exclude(_A,_B) :- hd(_A,_F,_V,neg), hd(_B,_F,_V,pos).
blocked(_W) :- better(_B,_W), fires(_B), exclude(_B,_W).
applied(_D) :- fires(_D), not blocked(_D).
k(_F,_V) :- init(_F,_V).
k(_F,_V) :- ab(yes(_F,_V)).
kn(_F,_V) :- initn(_F,_V).
kn(_F,_V) :- ab(no(_F,_V)).
kn(_F,_V) :- lit(_F,_V), k(_F,_W), _W != _V.
k(_F,false) :- kn(_F,true), bool(_F).
k(_F,true) :- kn(_F,false), bool(_F).
defeated(_D) :- hd(_D,_F,_V,pos), kn(_F,_V).
defeated(_D) :- hd(_D,_F,_V,neg), k(_F,_V).
defeated(_D) :- applied(_A), exclude(_A,_D), not better(_D,_A).
:- better(_B,_W), exclude(_B,_W), applied(_W), dbody(_B), not defeated(_B).
#defined k/2. #defined kn/2.
)";

const char* const kExogenousRules = R"(
abducible(exo(_A,t-1)) :- exog(_A).
occ(_A,t-1) :- ab(exo(_A,t-1)).
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

HistoryProgram::HistoryProgram(const Description& description, const ReasonerOptions& options)
  : description_(description), options_(options), encoding_(description)
{
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
  text += "dbody(" + id + ") :- #true" + guards.text() + closureBody(rule.body, "c") + ".\n";
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
      text += constraintRules(constraint, "k");
    }
  }
  text +=
      "weight(_X,_P) :- abducible(_X), _P = #min { _Q : price(_X,_Q) }, price(_X,_).\n#defined "
      "price/2.\n";
  text += "weight(exo(_A,_I)," + std::to_string(options_.exogenous_weight) +
          ") :- abducible(exo(_A,_I)).\n";
  text += "weight(fail(_A,_I)," + std::to_string(options_.exogenous_weight) +
          ") :- abducible(fail(_A,_I)), not imp(_A,_I).\n";
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
    text += "% " + toString(checked.record) + "\n" + (switchable ? "#external rec(" : "rec(") +
            number + ").\n";
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
    if (checked.record.step == 0 && fluent.kind != FluentKind::kStatic)
    {
      text += (literal.equal ? "init(" : "initn(") + pair + ") :- " + holds + ".\n";
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
  return text + "#defined rec/1. #defined said/1.\n";
}

void HistoryProgram::addTo(Solver& solver) const
{
  solver.add("base", {}, encoding_.signature() + closure());
  solver.add("state", {"t"}, encoding_.state());
  solver.add("trans", {"t"}, encoding_.transition());
  solver.add("exo", {"t"}, kExogenousRules);
  solver.add("minimize", {}, kMinimizeRules);
  solver.add("bound", {"r", "a"}, kBoundRules);
}

void HistoryProgram::groundHistory(Solver& solver, const std::vector<CheckedRecord>& records,
                                   int current_step, const Assumable& assumable,
                                   bool switchable) const
{
  solver.add("records", {}, recordRules(records, assumable, switchable));
  std::vector<Solver::Part> parts = {{"base", {}}, {"state", {0}}, {"records", {}}};
  for (int step = 1; step <= current_step; ++step)
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

std::string HistoryProgram::text(const std::vector<CheckedRecord>& records) const
{
  return "#program base.\n" + encoding_.signature() + closure() + "\n#program state(t).\n" +
         encoding_.state() + "\n#program trans(t).\n" + encoding_.transition() +
         "\n#program exo(t).\n" + kExogenousRules + "\n#program minimize.\n" + kMinimizeRules +
         "\n#program bound(r,a).\n" + kBoundRules + "\n#program records.\n" +
         recordRules(records, {}, false);
}

}  // namespace kr3::reasoner
