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
    writeSorts();
    writeDeclarations();
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

  // ---- Declarations

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
      static const std::set<std::string> kKnown = {"holds", "occurs", "success", "goal",
                                                   "something_happened"};
      if (kKnown.count(predicate.name) == 0)
      {
        result_.static_names.insert(predicate.name);
        result_.statics.push_back(predicate.sorts.empty()
                                      ? predicate.name
                                      : predicate.name + "(" + joined(predicate.sorts, ", ") + ")");
      }
    }
  }

  void declare(const Term& function, const sparc::Sort& sort, bool is_action)
  {
    (is_action ? result_.actions : result_.fluents)
        .push_back((is_action                             ? ""
                    : defined_sorts_.count(sort.name) > 0 ? "defined "
                                                          : "inertial ") +
                   signatureText(function));
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
    if (!simple || (!is_action && defined_sorts_.count(sort.name) > 0))
    {
      problems_.push_back({sort.position, "found a condition on the instances of " +
                                              part.function.name +
                                              ", expected one X != Y of an action or inertial "
                                              "fluent"});
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
  Signature result_;
};

}  // namespace

Signature signatureOf(const Program& program, std::vector<Diagnostic>& problems)
{
  return SignatureReader(program, problems).run();
}

}  // namespace kr3::reasoner::sparc
