#pragma once

#include <map>
#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"
#include "symbols.hpp"

namespace kr3::reasoner
{

/// The variables of one statement: collects the sorts of the positions they stand in, and reports
/// what does not fit. Private to the package.
class Scope
{
public:
  /// All three must outlive the scope.
  Scope(const Symbols& symbols, const SourcePosition& position, std::vector<Diagnostic>& problems);

  const FluentDeclaration* useFluent(const Atom& atom);
  const FluentDeclaration* useLiteral(const Literal& literal);
  void useValue(const FluentDeclaration& fluent, const Term& value, const SourcePosition& position);
  void useAction(const Atom& atom);
  void useActionVariable(const Term& variable);
  void useBody(const Body& body);

  /// A variable that must be bound elsewhere, as the argument of a default's name.
  void mention(const Term& term, const SourcePosition& position);

  /// Reports variables that nothing binds and variables whose positions have no common element.
  void finish();

  /// Reports any variable.
  void requireGround(const std::string& what);

private:
  struct Use
  {
    std::vector<std::string> sorts;
    SourcePosition position;
    bool is_action = false;
  };

  void useTerm(const Term& term, const std::string& sort, const SourcePosition& position);
  void useArguments(const Atom& atom, const std::vector<std::string>& sorts,
                    const std::string& what);
  void useCondition(const Condition& condition);
  void useUnknown(const Atom& atom);
  /// Reports `loc(R, office)` where loc is a function and `loc(R) = office` is meant.
  bool isPredicateOfFunction(const Literal& literal);
  void report(const SourcePosition& position, const std::string& message);
  [[nodiscard]] std::string nearest(const std::string& name,
                                    const std::vector<std::string>& candidates) const;

  const Symbols& symbols_;
  const SourcePosition& position_;
  std::vector<Diagnostic>& problems_;
  std::map<std::string, Use> variables_;
  std::map<std::string, SourcePosition> mentioned_;
};

}  // namespace kr3::reasoner
