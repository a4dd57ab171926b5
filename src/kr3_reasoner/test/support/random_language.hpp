#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "random_case.hpp"

namespace kr3::reasoner
{

using Strings = std::vector<std::string>;

/// A fluent, static or action with the sorts of its arguments; no value sort: boolean.
struct Symbol
{
  std::string name;
  Strings sorts;
  std::string value_sort;
};

inline std::string joined(const Strings& items, const std::string& separator)
{
  std::string text;
  for (const std::string& item : items)
  {
    text += (text.empty() ? "" : separator) + item;
  }
  return text;
}

/// A random signature, and random formulas over it.
class RandomLanguage
{
protected:
  RandomLanguage(std::uint64_t seed, const CaseSize& size) : random_(seed), size_(size)
  {
    things_.assign({"a", "b", "c", "e", "f"});
    things_.resize(static_cast<std::size_t>(between(1, std::min(size.max_things, 5))));
    places_.assign({"u", "v", "w", "x", "y", "z"});
    places_.resize(static_cast<std::size_t>(between(2, std::min(size.max_places, 6))));
    drawSignature();
    drawHeads();
  }

  // ---- Drawing ----

  int between(int low, int high)
  {
    return low + static_cast<int>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool chance(double probability)
  {
    return static_cast<double>(random_() % 1000000) < probability * 1e6;
  }
  template <typename Item>
  const Item& pick(const std::vector<Item>& items)
  {
    return items[random_() % items.size()];
  }
  std::string constant(const std::string& sort)
  {
    return sort == "place"   ? pick(places_)
           : sort == "level" ? pick(Strings{"1", "2"})
           : sort == "small" ? "a"
                             : pick(things_);
  }

  // ---- Signature ----

  void drawSignature()
  {
    const auto perhaps = [&](double probability, std::vector<Symbol>& where, const Symbol& symbol) {
      if (chance(probability))
      {
        where.push_back(symbol);
      }
    };
    perhaps(0.5, statics_, {"near", {"thing", "thing"}, ""});
    perhaps(0.4, statics_, {"home", {"thing"}, "place"});
    perhaps(0.85, inertial_, {"at", {"thing"}, "place"});
    perhaps(0.6, inertial_, {"wet", {"thing"}, ""});
    perhaps(0.3, inertial_, {"mode", {}, "level"});
    perhaps(inertial_.empty() ? 1.0 : 0.4, inertial_, {"on", {}, ""});
    perhaps(0.5, defined_, {"seen", {"thing"}, ""});
    perhaps(0.3, defined_, {"busy", {}, ""});
    perhaps(0.7, agent_, {"go", {"thing", "place"}, ""});
    perhaps(0.4, agent_, {"touch", {"thing"}, ""});
    perhaps(agent_.empty() ? 1.0 : 0.3, agent_, {"flip", {}, ""});
    perhaps(0.6, exogenous_, {"push", {"thing"}, ""});
    perhaps(0.2, exogenous_, {"burst", {}, ""});
  }

  /// Heads of the defaults, before the constraints, which then can set them against each other.
  void drawHeads()
  {
    const int count = chance(0.15) ? 0 : between(1, size_.max_defaults);
    for (int i = 0; i < count; ++i)
    {
      std::set<std::string> bound = {"X"};
      heads_.push_back(literal(pick(inertial_), bound, false, 0.2));
    }
  }

  static std::string section(const std::string& name, const std::vector<Symbol>& symbols,
                             const std::string& kind)
  {
    std::string text = name.empty() ? "" : name + "\n";
    for (const Symbol& symbol : symbols)
    {
      text += "  " + kind + symbol.name +
              (symbol.sorts.empty() ? "" : "(" + joined(symbol.sorts, ", ") + ")") +
              (symbol.value_sort.empty() ? "" : " : " + symbol.value_sort) + ".\n";
    }
    return text;
  }

  std::string facts()
  {
    std::string text;
    for (const Symbol& symbol : statics_)
    {
      for (int i = 0; i < 2; ++i)
      {
        text += "  " + ground(symbol) +
                (symbol.value_sort.empty() ? "" : " = " + constant(symbol.value_sort)) + ".\n";
        if (!symbol.value_sort.empty())
        {
          break;  // one value only
        }
      }
    }
    return text.empty() ? "" : "facts\n" + text;
  }

  std::string ground(const Symbol& symbol)
  {
    Strings arguments;
    for (const std::string& sort : symbol.sorts)
    {
      arguments.push_back(constant(sort));
    }
    return arguments.empty() ? symbol.name : symbol.name + "(" + joined(arguments, ", ") + ")";
  }

  // ---- Formulas ----

  /// A variable or constant for a position; `bound` are the variables that may stand there, and
  /// gets what was used.
  std::string term(const std::string& sort, std::set<std::string>& bound, bool may_bind)
  {
    const std::string variable = sort == "place"   ? "V"
                                 : sort == "level" ? "L"
                                 : chance(0.75)    ? "X"
                                                   : "Y";
    if ((may_bind || bound.count(variable) > 0) &&
        chance(sort == "place" || sort == "level" ? 0.3 : 0.8))
    {
      bound.insert(variable);
      return variable;
    }
    return constant(sort);
  }

  std::string atom(const Symbol& symbol, std::set<std::string>& bound, bool may_bind)
  {
    Strings arguments;
    for (const std::string& sort : symbol.sorts)
    {
      arguments.push_back(term(sort, bound, may_bind));
    }
    return arguments.empty() ? symbol.name : symbol.name + "(" + joined(arguments, ", ") + ")";
  }

  std::string literal(const Symbol& symbol, std::set<std::string>& bound, bool may_bind,
                      double negative)
  {
    const std::string text = atom(symbol, bound, may_bind);
    if (symbol.value_sort.empty())
    {
      return (chance(negative) ? "-" : "") + text;
    }
    return text + (chance(negative) ? " != " : " = ") + term(symbol.value_sort, bound, may_bind);
  }

  /// Conditions, each of a fluent, a static, a sort or a comparison.
  Strings body(int count, std::set<std::string>& bound, bool with_defined)
  {
    Strings conditions;
    for (int i = 0; i < count; ++i)
    {
      if (chance(0.12) && bound.count("X") > 0)
      {
        conditions.push_back(chance(0.5) ? "small(X)" : "not small(X)");
      }
      else if (chance(0.2) && bound.count("X") > 0 && bound.count("Y") > 0)
      {
        conditions.emplace_back("X != Y");
      }
      else if (chance(0.15) && bound.count("V") > 0)
      {
        conditions.push_back("V != " + constant("place"));
      }
      else if (chance(0.15) && bound.count("L") > 0)
      {
        conditions.emplace_back("L < 2");
      }
      else
      {
        const bool is_static = chance(0.2) && !statics_.empty();
        const bool is_defined = with_defined && chance(0.25) && !defined_.empty();
        const Symbol& symbol = is_static    ? pick(statics_)
                               : is_defined ? pick(defined_)
                                            : pick(inertial_);
        conditions.push_back(literal(symbol, bound, true, 0.3));
      }
    }
    return conditions;
  }

  static std::string ifText(const Strings& body)
  {
    return body.empty() ? "" : " if " + joined(body, ", ");
  }

  static std::string contraryText(const std::string& literal)
  {
    const std::size_t unequal = literal.find(" != ");
    const std::size_t equal = literal.find(" = ");
    if (unequal != std::string::npos)
    {
      return literal.substr(0, unequal) + " = " + literal.substr(unequal + 4);
    }
    if (equal != std::string::npos)
    {
      return literal.substr(0, equal) + " != " + literal.substr(equal + 3);
    }
    return literal[0] == '-' ? literal.substr(1) : "-" + literal;
  }

  std::mt19937_64 random_;
  CaseSize size_;
  Strings things_;
  Strings places_;
  std::vector<Symbol> statics_;
  std::vector<Symbol> inertial_;
  std::vector<Symbol> defined_;
  std::vector<Symbol> agent_;
  std::vector<Symbol> exogenous_;
  Strings heads_;
  std::map<std::string, std::string> truth_;
};

}  // namespace kr3::reasoner
