#include <algorithm>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "diagnostics.hpp"
#include "kr3_reasoner/sparc.hpp"
#include "print_text.hpp"
#include "sparc_bodies.hpp"
#include "sparc_general.hpp"
#include "sparc_signature.hpp"
#include "sparc_syntax.hpp"
#include "sparc_terms.hpp"
#include "text_file.hpp"

namespace kr3::reasoner
{

namespace
{

using sparc::fluentText;
using sparc::ifText;
using sparc::isAtom;
using sparc::Literal;
using sparc::Program;
using sparc::Refusal;
using sparc::Rule;
using sparc::Step;
using sparc::stepOf;
using sparc::Term;
using sparc::text;

/// Translates one program.
class Importer
{
public:
  /// Both must outlive the importer.
  Importer(const Program& program, std::vector<Diagnostic>& problems)
    : program_(program)
    , problems_(problems)
    , signature_(sparc::signatureOf(program, problems))
    , completeness_(sparc::completenessOf(program, signature_))
    , bodies_(signature_, completeness_)
    , axioms_(signature_.axioms)
  {
  }

  SparcImport run()
  {
    for (const Rule& rule : program_.rules)
    {
      try
      {
        translate(rule);
      }
      catch (const Refusal& refusal)
      {
        problems_.push_back({rule.position, refusal.why});
      }
    }
    closeInitialState();
    std::ostringstream description;
    const auto section = [&](const char* name, const std::vector<std::string>& statements) {
      if (!statements.empty())
      {
        description << name << "\n";
        for (const std::string& statement : statements)
        {
          description << "  " << statement << ".\n";
        }
      }
    };
    section("sorts", signature_.sorts);
    section("statics", signature_.statics);
    section("facts", facts_);
    section("fluents", signature_.fluents);
    section("actions", signature_.actions);
    section("axioms", axioms_);
    section("defaults", defaults_);
    return {description.str(), history_, goals_};
  }

private:
  // ---- Rules

  [[nodiscard]] static std::vector<const Literal*> occurrences(const Rule& rule)
  {
    std::vector<const Literal*> found;
    for (const Literal& literal : rule.body)
    {
      if (isAtom(literal, "occurs", 2))
      {
        found.push_back(&literal);
      }
    }
    return found;
  }

  void translate(const Rule& rule)
  {
    if (sparc::isGeneral(rule) && !sparc::isDefaultWithException(rule, program_))
    {
      return;
    }
    if (rule.is_choice)
    {
      throw Refusal{"found a choice rule, expected one only for the actions of a plan"};
    }
    if (rule.restores_consistency)
    {
      translateException(rule);
      return;
    }
    if (rule.head.size() > 1)
    {
      translateDisjunction(rule);
      return;
    }
    if (rule.head.empty())
    {
      translateConstraint(rule);
      return;
    }
    const Literal& head = rule.head[0];
    if (rule.body.empty() && addRecord(head))
    {
      return;
    }
    if (isAtom(head, "holds", 2))
    {
      translateHolds(rule, head);
    }
    else if ((isAtom(head, "occurs", 2) && head.is_negative) ||
             (isAtom(head, "impossible", 2) && !head.is_negative))
    {
      translateExecutability(rule, head);
    }
    else if (isAtom(head, "goal", 1))
    {
      goals_.push_back(joined(bodies_.conditions(rule, stepOf(head.atom.arguments[0])), " and "));
    }
    else if (bodies_.isStatic(head) && !head.is_default_negated)
    {
      const std::string literal = (head.is_negative ? "-" : "") + text(head.atom);
      (rule.body.empty() ? facts_ : axioms_)
          .push_back(literal + ifText(bodies_.conditions(rule, Step{})));
    }
    else
    {
      throw Refusal{"found " + head.atom.name +
                    " in the head, expected holds, -occurs, impossible, goal or a static"};
    }
  }

  // ---- What happened

  /// Facts about what was observed and done. @return false  the fact is about something else
  bool addRecord(const Literal& fact)
  {
    const std::string& name = fact.atom.name;
    const std::vector<Term>& arguments = fact.atom.arguments;
    const bool observed = name == "obs" && (arguments.size() == 2 || arguments.size() == 3);
    const bool done = (name == "hpd" && (arguments.size() == 2 || arguments.size() == 3)) ||
                      ((name == "attempt" || name == "occurs") && arguments.size() == 2);
    if (fact.is_negative || (!observed && !done))
    {
      return false;
    }
    const std::string value = arguments.size() == 3 ? arguments[1].name : "true";
    const std::string& step = arguments.back().name;
    if ((value != "true" && value != "false") || step.empty() ||
        step.find_first_not_of("0123456789") != std::string::npos)
    {
      throw Refusal{"found " + name + " with " + value + " at " + step +
                    ", expected true or false, and a number as its step"};
    }
    if (done && value == "false")
    {
      throw Refusal{
          "found an action that did not happen, expected what did: KR3 supposes no other"};
    }
    const std::string what = text(arguments[0]);
    history_ += observed ? "obs(" + what + ", " + value + ", " + step + ").\n"
                         : (name == "attempt" ? "attempt(" : "hpd(") + what + ", " + step + ").\n";
    return true;
  }

  /// The instances of fluents that the program takes to be false initially, as records.
  void closeInitialState()
  {
    for (const std::string& name : completeness_.closed_initially)
    {
      const auto fluent = signature_.inertial.find(name);
      if (fluent != signature_.inertial.end())
      {
        Term instance{name, {}, false};
        closeInstances(fluent->second, instance);
      }
    }
  }

  void closeInstances(const std::vector<std::string>& sorts, Term& instance)
  {
    constexpr std::size_t kMaxHistory = 10'000'000;  // bytes
    if (history_.size() > kMaxHistory)
    {
      return;
    }
    if (instance.arguments.size() == sorts.size())
    {
      if (known_.count(text(instance)) == 0)
      {
        history_ += "init(" + text(instance) + ", false).\n";
      }
      return;
    }
    for (const std::string& element : signature_.elements[sorts[instance.arguments.size()]])
    {
      instance.arguments.push_back({element, {}, false});
      closeInstances(sorts, instance);
      instance.arguments.pop_back();
    }
  }

  // ---- Defaults

  /// `holds(f, 0) :- #s(X), not ab(X).` and `holds(f, 0) :- #s(X), not -holds(f, 0).`
  void translateInitialRule(const Rule& rule, const Literal& head)
  {
    Rule rest = rule;
    const auto negated =
        std::find_if(rest.body.begin(), rest.body.end(),
                     [](const Literal& literal) { return literal.is_default_negated; });
    if (negated == rest.body.end())
    {
      throw Refusal{"found a rule about step 0, expected a fact or a default, which has a 'not'"};
    }
    const bool by_name = sparc::isAbnormality(negated->atom.name) && !negated->is_negative;
    const bool by_contrary = negated->atom == head.atom && negated->is_negative != head.is_negative;
    if (!by_name && !by_contrary)
    {
      throw Refusal{
          "found 'not' in a rule about step 0, expected 'not ab(...)' or the contrary of "
          "its head, as in a default"};
    }
    std::string name = by_name ? text(negated->atom) : "";
    if (!by_name)
    {
      std::vector<std::string> variables;
      for (const Term& argument : head.atom.arguments[0].arguments)
      {
        if (argument.is_variable)
        {
          variables.push_back(argument.name);
        }
      }
      name = "d" + std::to_string(defaults_.size() + 1) +
             (variables.empty() ? "" : "(" + joined(variables, ", ") + ")");
    }
    rest.body.erase(negated);
    defaults_.push_back(name + ": " + (head.is_negative ? "-" : "") + fluentText(head) +
                        ifText(bodies_.conditions(rest, Step{"", false, true})));
  }

  /// `ab(X) :+ #s(X).` and `-holds(f, 0) :+ ...`: that a default has exceptions, KR3 knows.
  static void translateException(const Rule& rule)
  {
    const bool exception =
        rule.head.size() == 1 &&
        (sparc::isAbnormality(rule.head[0].atom.name) ||
         (isAtom(rule.head[0], "holds", 2) && rule.head[0].atom.arguments[1].name == "0"));
    if (!exception)
    {
      throw Refusal{
          "found a CR-rule (:+), expected one only for plans and for exceptions to "
          "defaults: ab(...) or holds(..., 0)"};
    }
  }

  /// `-occurs(a, I) | -occurs(b, I) :- ...`: not both.
  void translateDisjunction(const Rule& rule)
  {
    Rule together = rule;
    together.head.clear();
    for (Literal action : rule.head)
    {
      if (!isAtom(action, "occurs", 2) || !action.is_negative)
      {
        throw Refusal{"found a disjunction, expected one literal in the head, or several -occurs"};
      }
      action.is_negative = false;
      together.body.push_back(action);
    }
    translateConstraint(together);
  }

  void translateHolds(const Rule& rule, const Literal& head)
  {
    const Step step = stepOf(head.atom.arguments[1]);
    const std::string literal = (head.is_negative ? "-" : "") + fluentText(head);
    const std::vector<const Literal*> actions = occurrences(rule);
    if (step.initial && !rule.body.empty())
    {
      translateInitialRule(rule, head);
    }
    else if (step.initial)
    {
      known_.insert(fluentText(head));
      history_ += "init(" + fluentText(head) + (head.is_negative ? ", false).\n" : ", true).\n");
    }
    else if (step.next)
    {
      if (actions.size() != 1 || stepOf(actions[0]->atom.arguments[1]).base != step.base ||
          stepOf(actions[0]->atom.arguments[1]).next || actions[0]->is_negative)
      {
        throw Refusal{"found a head at the next step, expected one occurs at " + step.base};
      }
      axioms_.push_back(text(actions[0]->atom.arguments[0]) + " causes " + literal +
                        ifText(bodies_.conditions(rule, step)));
    }
    else if (!actions.empty())
    {
      throw Refusal{"found occurs in a constraint, expected a head at the next step"};
    }
    else
    {
      std::vector<std::string> body = bodies_.conditions(rule, step);
      bodies_.addUnequal(head, body);
      axioms_.push_back(literal + ifText(body));
    }
  }

  void translateExecutability(const Rule& rule, const Literal& head)
  {
    const Step step = stepOf(head.atom.arguments[1]);
    std::string actions = text(head.atom.arguments[0]);
    for (const Literal* occurrence : occurrences(rule))
    {
      const Step other = stepOf(occurrence->atom.arguments[1]);
      if (occurrence->is_negative || other.next || other.base != step.base)
      {
        throw Refusal{"found occurs at another step, expected " + step.base};
      }
      actions += ", " + text(occurrence->atom.arguments[0]);
    }
    axioms_.push_back("impossible " + actions + ifText(bodies_.conditions(rule, step)));
  }

  void translateConstraint(const Rule& rule)
  {
    const std::vector<const Literal*> actions = occurrences(rule);
    std::optional<Step> step;
    for (const Literal& literal : rule.body)
    {
      if (isAtom(literal, "holds", 2) || isAtom(literal, "occurs", 2))
      {
        const Step here = stepOf(literal.atom.arguments[1]);
        step = step ? step : here;
      }
    }
    if (!step || step->initial || step->next)
    {
      throw Refusal{"found a constraint that is not about a step I"};
    }
    std::vector<std::string> names;
    for (const Literal* occurrence : actions)
    {
      const Step here = stepOf(occurrence->atom.arguments[1]);
      if (occurrence->is_negative || here.next || here.base != step->base)
      {
        throw Refusal{"found occurs at another step, expected " + step->base};
      }
      names.push_back(text(occurrence->atom.arguments[0]));
    }
    axioms_.push_back((names.empty() ? "false" : "impossible " + joined(names, ", ")) +
                      ifText(bodies_.conditions(rule, *step)));
  }

  const Program& program_;
  std::vector<Diagnostic>& problems_;
  sparc::Signature signature_;
  const sparc::Completeness completeness_;
  const sparc::BodyWriter bodies_;
  std::vector<std::string> facts_;
  std::vector<std::string> axioms_;
  std::vector<std::string> defaults_;
  std::set<std::string> known_;  // fluents that the program decides at step 0
  std::string history_;
  std::vector<std::string> goals_;
};

}  // namespace

SparcImport importSparc(const std::string& text, const std::string& file)
{
  std::vector<Diagnostic> problems;
  const Program program = sparc::parse(text, file, problems);
  SparcImport result = Importer(program, problems).run();
  throwIfAny(std::move(problems));
  return result;
}

SparcImport readSparc(const std::string& path)
{
  return importSparc(readTextFile(path), path);
}

}  // namespace kr3::reasoner
