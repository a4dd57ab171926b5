#include "sparc_signature.hpp"

#include <algorithm>
#include <utility>

#include "print_text.hpp"
#include "sparc_terms.hpp"

namespace kr3::reasoner::sparc
{

namespace
{

class SignatureReader
{
public:
  /// Both must outlive the reader.
  SignatureReader(const Program& program, std::vector<Diagnostic>& problems)
    : program_(program), problems_(problems)
  {
  }

  Signature run()
  {
    findKinds();
    if (result_.step_sort.empty())
    {
      problems_.push_back(
          {program_.rules.empty() ? SourcePosition{} : program_.rules[0].position,
           "found no declarations holds(#fluent, #step) and occurs(#action, #step), "
           "expected a program about actions"});
    }
    writeSorts();
    writeDeclarations();
    for (const auto& name : fluent_sorts_)
    {
      addFluentsOf(name, name);
    }
    result_.action_sorts = action_sorts_;
    return std::move(result_);
  }

private:
  // ---- Which sorts hold fluents, actions and steps

  [[nodiscard]] const sparc::Sort* sortNamed(const std::string& name) const
  {
    const auto found = std::find_if(program_.sorts.begin(), program_.sorts.end(),
                                    [&](const sparc::Sort& sort) { return sort.name == name; });
    return found == program_.sorts.end() ? nullptr : &*found;
  }

  void addLeaves(const std::string& name, std::set<std::string>& leaves)
  {
    const sparc::Sort* sort = sortNamed(name);
    if (sort == nullptr || !leaves.insert(name).second)
    {
      return;
    }
    for (const sparc::SortPart& part : sort->parts)
    {
      if (!part.sort.empty())
      {
        addLeaves(part.sort, leaves);
      }
    }
  }

  void findKinds()
  {
    for (const sparc::Predicate& predicate : program_.predicates)
    {
      if ((predicate.name == "holds" || predicate.name == "occurs") && predicate.sorts.size() == 2)
      {
        addLeaves(predicate.sorts[0], predicate.name == "holds" ? fluent_sorts_ : action_sorts_);
        result_.step_sort = predicate.sorts[1];
      }
    }
    // -holds(F,I) :- #defined_fluent(F), not holds(F,I).
    for (const Rule& rule : program_.rules)
    {
      closed_fluents_.insert(closedFluent(rule));
      const auto closed =
          std::find_if(rule.body.begin(), rule.body.end(), [](const Literal& literal) {
            return literal.is_default_negated && isAtom(literal, "holds", 2);
          });
      if (rule.head.size() == 1 && rule.head[0].is_negative && isAtom(rule.head[0], "holds", 2) &&
          rule.head[0].atom.arguments[0].is_variable &&
          rule.head[0].atom.arguments[1].is_variable && closed != rule.body.end())
      {
        for (const Literal& literal : rule.body)
        {
          if (literal.atom.name[0] == '#')
          {
            addLeaves(literal.atom.name.substr(1), defined_sorts_);
          }
        }
      }
    }
  }

  /// Adds the fluents of a sort, and of those it is the union of, to those of `of`.
  void addFluentsOf(const std::string& name, const std::string& of)
  {
    std::set<std::string> leaves;
    addLeaves(name, leaves);
    for (const std::string& leaf : leaves)
    {
      for (const sparc::SortPart& part : sortNamed(leaf)->parts)
      {
        result_.fluents_of[of].insert(part.elements.begin(), part.elements.end());
        if (!part.function.name.empty())
        {
          result_.fluents_of[of].insert(part.function.name);
        }
      }
    }
  }

  // ---- Declarations

  void addElements(const std::string& name, std::vector<std::string>& elements, int depth = 0) const
  {
    constexpr int kMaxDepth = 50;
    const sparc::Sort* sort = sortNamed(name);
    if (sort == nullptr || depth > kMaxDepth)
    {
      return;
    }
    for (const sparc::SortPart& part : sort->parts)
    {
      elements.insert(elements.end(), part.elements.begin(), part.elements.end());
      addElements(part.sort, elements, depth + 1);
    }
  }

  void writeSorts()
  {
    for (const sparc::Sort& sort : program_.sorts)
    {
      if (fluent_sorts_.count(sort.name) > 0 || action_sorts_.count(sort.name) > 0 ||
          sort.name == result_.step_sort)
      {
        continue;
      }
      std::vector<std::string> parts;
      for (const sparc::SortPart& part : sort.parts)
      {
        if (!part.function.name.empty())
        {
          problems_.push_back({sort.position, "found functions in the sort " + sort.name +
                                                  ", expected them in fluents and actions only"});
        }
        else
        {
          parts.push_back(part.sort.empty() ? "{" + joined(part.elements, ", ") + "}" : part.sort);
        }
      }
      result_.sorts.push_back(sort.name + " = " + joined(parts, " + "));
      addElements(sort.name, result_.elements[sort.name]);
    }
  }

  static std::string signatureText(const Term& function)
  {
    std::vector<std::string> sorts;
    for (const Term& argument : function.arguments)
    {
      sorts.push_back(argument.name);
    }
    return sorts.empty() ? function.name : function.name + "(" + joined(sorts, ", ") + ")";
  }

  void writeDeclarations()
  {
    for (const sparc::Sort& sort : program_.sorts)
    {
      const bool is_action = action_sorts_.count(sort.name) > 0;
      if (!is_action && fluent_sorts_.count(sort.name) == 0)
      {
        continue;
      }
      for (const sparc::SortPart& part : sort.parts)
      {
        for (const std::string& name : part.elements)
        {
          declare(Term{name, {}, false}, sort, is_action);
        }
        if (!part.function.name.empty())
        {
          declare(part.function, sort, is_action);
          exclude(part, sort, is_action);
        }
      }
    }
    for (const sparc::Predicate& predicate : program_.predicates)
    {
      static const std::set<std::string> kKnown = {
          "holds", "occurs", "success", "goal",       "something_happened",
          "obs",   "hpd",    "attempt", "impossible", "current_step"};
      if (kKnown.count(predicate.name) == 0 && !isAbnormality(predicate.name) &&
          !isAboutSteps(predicate))
      {
        result_.static_names.insert(predicate.name);
        result_.statics.push_back(predicate.sorts.empty()
                                      ? predicate.name
                                      : predicate.name + "(" + joined(predicate.sorts, ", ") + ")");
      }
    }
  }

  [[nodiscard]] bool isDefined(const std::string& fluent, const sparc::Sort& sort) const
  {
    return defined_sorts_.count(sort.name) > 0 || closed_fluents_.count(fluent) > 0;
  }

  /// A predicate of the general axioms: it is about actions, fluents or steps.
  [[nodiscard]] bool isAboutSteps(const sparc::Predicate& predicate) const
  {
    return std::any_of(predicate.sorts.begin(), predicate.sorts.end(),
                       [&](const std::string& sort) {
      return sort == result_.step_sort || action_sorts_.count(sort) > 0 ||
             fluent_sorts_.count(sort) > 0;
    });
  }

  /// By convention: #exogenous_action, #exo_action, #physical_exogenous_action.
  static bool isExogenous(const std::string& sort)
  {
    return sort.find("exogenous") != std::string::npos || sort.rfind("exo_", 0) == 0;
  }

  void declare(const Term& function, const sparc::Sort& sort, bool is_action)
  {
    const std::string text = signatureText(function);
    if (is_action)
    {
      result_.actions.push_back((isExogenous(sort.name) ? "exogenous " : "") + text);
    }
    else if (isDefined(function.name, sort))
    {
      result_.defined.insert(function.name);
      result_.fluents.push_back("defined " + text);
    }
    else
    {
      for (const Term& argument : function.arguments)
      {
        result_.inertial[function.name].push_back(argument.name);
      }
      result_.inertial[function.name];
      result_.fluents.push_back("inertial " + text);
    }
  }

  /// `put(#block(X), #location(Y)) : X != Y` keeps some instances out.
  void exclude(const sparc::SortPart& part, const sparc::Sort& sort, bool is_action)
  {
    if (part.conditions.empty())
    {
      return;
    }
    const bool simple = part.conditions.size() == 1 && part.conditions[0].relation == "!=" &&
                        part.variables.size() == part.function.arguments.size();
    if (!simple)
    {
      problems_.push_back({sort.position, "found a condition on the instances of " +
                                              part.function.name + ", expected one X != Y"});
      return;
    }
    if (!is_action && isDefined(part.function.name, sort))
    {
      const auto place = [&](const std::string& variable) {
        const auto found =
            std::find_if(part.variables.begin(), part.variables.end(),
                         [&](const Term& argument) { return argument.name == variable; });
        return static_cast<std::size_t>(found - part.variables.begin());
      };
      result_.unequal[part.function.name] = {place(part.conditions[0].atom.name),
                                             place(part.conditions[0].right.name)};
      return;
    }
    Term instance = part.function;
    instance.arguments = part.variables;
    const std::string same =
        " if " + part.conditions[0].atom.name + " = " + part.conditions[0].right.name;
    result_.axioms.push_back((is_action ? "impossible " : "-") + text(instance) + same);
  }

  const Program& program_;
  std::vector<Diagnostic>& problems_;
  std::set<std::string> fluent_sorts_;
  std::set<std::string> action_sorts_;
  std::set<std::string> defined_sorts_;
  std::set<std::string> closed_fluents_;
  Signature result_;
};

}  // namespace

Signature signatureOf(const Program& program, std::vector<Diagnostic>& problems)
{
  return SignatureReader(program, problems).run();
}

}  // namespace kr3::reasoner::sparc
