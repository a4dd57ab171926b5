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
#include "sparc_signature.hpp"
#include "sparc_syntax.hpp"
#include "sparc_terms.hpp"
#include "text_file.hpp"

namespace kr3::reasoner
{

namespace
{

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
    : program_(program), problems_(problems), signature_(sparc::signatureOf(program, problems))
  {
    axioms_ = signature_.axioms;
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
    return {description.str(), history_, goals_};
  }

private:
  // ---- Rules

  [[nodiscard]] bool isStatic(const Literal& literal) const
  {
    return literal.relation.empty() && signature_.static_names.count(literal.atom.name) > 0;
  }

  /// The body without what is about occurrences and steps; all fluents must be about `step`.
  std::vector<std::string> conditions(const Rule& rule, const Step& step)
  {
    std::vector<std::string> result;
    for (const Literal& literal : rule.body)
    {
      if (literal.is_default_negated)
      {
        throw Refusal{"found 'not', expected it in closed worlds and inertia only"};
      }
      const std::string& name = literal.atom.name;
      if (!literal.relation.empty())
      {
        const bool about_step = literal.atom.name == step.base || literal.right.name == step.base;
        if (!about_step)  // I < n bounds the steps, which KR3 does itself
        {
          result.push_back(text(literal.atom) + " " + literal.relation + " " + text(literal.right));
        }
      }
      else if (name[0] == '#')
      {
        if (literal.atom.arguments.size() != 1)
        {
          throw Refusal{"found the sort " + name + " without its argument"};
        }
        if (name.substr(1) != signature_.step_sort)
        {
          result.push_back(name.substr(1) + "(" + text(literal.atom.arguments[0]) + ")");
        }
      }
      else if (isAtom(literal, "holds", 2))
      {
        const Step here = stepOf(literal.atom.arguments[1]);
        if (here.base != step.base || here.next)
        {
          throw Refusal{"found holds at another step, expected all conditions at " + step.base};
        }
        result.push_back((literal.is_negative ? "-" : "") + fluentText(literal));
      }
      else if (isStatic(literal))
      {
        result.push_back((literal.is_negative ? "-" : "") + text(literal.atom));
      }
      else if (!isAtom(literal, "occurs", 2))
      {
        throw Refusal{"found " + name + " in a body, expected holds, occurs, a sort or a static"};
      }
    }
    return result;
  }

  static std::string fluentText(const Literal& literal)
  {
    const Term& fluent = literal.atom.arguments[0];
    if (fluent.is_variable)
    {
      throw Refusal{"found the variable " + fluent.name +
                    " for a fluent, expected it in closed worlds and inertia only"};
    }
    return text(fluent);
  }

  static std::string ifText(const std::vector<std::string>& body)
  {
    return body.empty() ? "" : " if " + joined(body, ", ");
  }

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

  /// What every such program has, and KR3 brings itself.
  [[nodiscard]] static bool isGeneral(const Rule& rule)
  {
    static const std::set<std::string> kPlanning = {"success", "goal", "something_happened"};
    const auto plans = [](const Literal& literal) {
      return literal.relation.empty() && kPlanning.count(literal.atom.name) > 0;
    };
    const bool is_goal = rule.head.size() == 1 && rule.head[0].atom.name == "goal";
    if (!is_goal && (std::any_of(rule.head.begin(), rule.head.end(), plans) ||
                     std::any_of(rule.body.begin(), rule.body.end(), plans)))
    {
      return true;
    }
    // a static's closed world: -next_to(A, B) :- not next_to(A, B).
    if (rule.head.size() == 1 && rule.head[0].is_negative && rule.body.size() == 1 &&
        rule.body[0].is_default_negated && !rule.body[0].is_negative &&
        rule.head[0].atom == rule.body[0].atom)
    {
      return true;
    }
    // inertia, and closed worlds: the head and what it is about are variables
    return rule.head.size() == 1 &&
           (isAtom(rule.head[0], "holds", 2) || isAtom(rule.head[0], "occurs", 2)) &&
           rule.head[0].atom.arguments[0].is_variable &&
           std::any_of(rule.body.begin(), rule.body.end(),
                       [](const Literal& literal) { return literal.is_default_negated; });
  }

  void translate(const Rule& rule)
  {
    if (isGeneral(rule))
    {
      return;
    }
    if (rule.head.size() > 1)
    {
      throw Refusal{"found a disjunction, expected one literal in the head"};
    }
    if (rule.head.empty())
    {
      translateConstraint(rule);
      return;
    }
    const Literal& head = rule.head[0];
    if (isAtom(head, "holds", 2))
    {
      translateHolds(rule, head);
    }
    else if (isAtom(head, "occurs", 2) && head.is_negative)
    {
      translateExecutability(rule, head);
    }
    else if (isAtom(head, "goal", 1))
    {
      goals_.push_back(joined(conditions(rule, stepOf(head.atom.arguments[0])), " and "));
    }
    else if (isStatic(head) && !head.is_default_negated)
    {
      const std::string literal = (head.is_negative ? "-" : "") + text(head.atom);
      (rule.body.empty() ? facts_ : axioms_).push_back(literal + ifText(conditions(rule, Step{})));
    }
    else
    {
      throw Refusal{"found " + head.atom.name +
                    " in the head, expected holds, -occurs, goal or a "
                    "static"};
    }
  }

  void translateHolds(const Rule& rule, const Literal& head)
  {
    const Step step = stepOf(head.atom.arguments[1]);
    const std::string literal = (head.is_negative ? "-" : "") + fluentText(head);
    const std::vector<const Literal*> actions = occurrences(rule);
    if (step.initial)
    {
      if (!rule.body.empty())
      {
        throw Refusal{"found a rule about step 0, expected a fact: write it as a default"};
      }
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
                        ifText(conditions(rule, step)));
    }
    else if (!actions.empty())
    {
      throw Refusal{"found occurs in a constraint, expected a head at the next step"};
    }
    else
    {
      axioms_.push_back(literal + ifText(conditions(rule, step)));
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
    axioms_.push_back("impossible " + actions + ifText(conditions(rule, step)));
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
                      ifText(conditions(rule, *step)));
  }

  const Program& program_;
  std::vector<Diagnostic>& problems_;
  sparc::Signature signature_;
  std::vector<std::string> facts_;
  std::vector<std::string> axioms_;
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
