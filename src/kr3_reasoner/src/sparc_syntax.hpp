#pragma once

#include <string>
#include <vector>

#include "kr3_reasoner/language.hpp"

/// The syntax of the part of SPARC that is imported. Private to the package.
namespace kr3::reasoner::sparc
{

/// A constant, number, variable, or a function applied to terms; `I+1` is the function `+`. A term
/// that begins with '#' is a sort.
struct Term
{
  std::string name;
  std::vector<Term> arguments;
  bool is_variable = false;

  bool operator==(const Term& other) const
  {
    return name == other.name && is_variable == other.is_variable && arguments == other.arguments;
  }
};

/// `[not] [-] atom`, or a comparison of two terms.
struct Literal
{
  bool is_default_negated = false;
  bool is_negative = false;
  Term atom;             ///< of a comparison the left side
  std::string relation;  ///< empty of an atom
  Term right;
};

/// `head :- body.` with a disjunction of literals as the head, `head :+ body.` of CR-Prolog, or
/// `1 {l1 : ...; l2 : ...} 1 :- body.`, of which the literals are kept.
struct Rule
{
  std::vector<Literal> head;
  std::vector<Literal> body;
  SourcePosition position;
  bool is_choice = false;
  bool restores_consistency = false;  ///< `:+`
};

/// One summand of a sort: a set of constants and numbers, another sort, or `f(#s1(X), #s2(Y)) : X
/// != Y`.
struct SortPart
{
  std::vector<std::string> elements;
  std::string sort;                 ///< without '#'
  Term function;                    ///< its arguments are names of sorts, without '#'
  std::vector<Term> variables;      ///< of the arguments, where there is a condition
  std::vector<Literal> conditions;  ///< comparisons
};

struct Sort
{
  std::string name;  ///< without '#'
  std::vector<SortPart> parts;
  SourcePosition position;
};

/// `next_to(#room, #room).`
struct Predicate
{
  std::string name;
  std::vector<std::string> sorts;  ///< without '#'
  SourcePosition position;
};

struct Program
{
  std::vector<Sort> sorts;
  std::vector<Predicate> predicates;
  std::vector<Rule> rules;
};

/// Parses a program; statements that are not understood are reported and left out.
[[nodiscard]] Program parse(const std::string& text, const std::string& file,
                            std::vector<Diagnostic>& problems);

}  // namespace kr3::reasoner::sparc
