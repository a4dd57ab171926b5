#include "random_case.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

namespace
{

using Strings = std::vector<std::string>;

/// A fluent, static or action with the sorts of its arguments; no value sort: boolean.
struct Symbol
{
  std::string name;
  Strings sorts;
  std::string value_sort;
};

std::string joined(const Strings& items, const std::string& separator)
{
  std::string text;
  for (const std::string& item : items)
  {
    text += (text.empty() ? "" : separator) + item;
  }
  return text;
}

/// Draws one description and history; the description may be one that the language refuses.
class Writer
{
public:
  Writer(std::uint64_t seed, const CaseSize& size) : random_(seed), size_(size)
  {
    things_.assign({"a", "b", "c", "e", "f"});
    things_.resize(static_cast<std::size_t>(between(1, std::min(size.max_things, 5))));
    places_.assign({"u", "v", "w", "x", "y", "z"});
    places_.resize(static_cast<std::size_t>(between(2, std::min(size.max_places, 6))));
    drawSignature();
    drawHeads();
  }

  std::string description()
  {
    std::string text =
        "sorts\n  small = {a}.\n  thing = small" +
        (things_.size() > 1
             ? " + {" + joined(Strings(things_.begin() + 1, things_.end()), ", ") + "}"
             : "") +
        ".\n  place = {" + joined(places_, ", ") + "}.\n  level = 1..2.\n";
    text += section("statics", statics_, "") + facts();
    text += section("fluents", inertial_, "inertial ") +
            (defined_.empty() ? "" : section("", defined_, "defined "));
    text += section("actions", agent_, "") + section("", exogenous_, "exogenous ");
    text += "axioms\n" + axioms() + "defaults\n" + defaults();
    return text;
  }

  std::string history()
  {
    std::string text;
    const int steps = between(0, size_.max_steps);
    for (int step = 0; step < steps && !size_.actions_in_language_only; ++step)
    {
      if (!agent_.empty() && chance(0.85))
      {
        text += (chance(0.3) ? "attempt(" : "hpd(") + ground(pick(agent_)) + ", " +
                std::to_string(step) + ").\n";
      }
      if (chance(0.1) && !agent_.empty())
      {
        text += "attempt(" + ground(pick(agent_)) + ", " + std::to_string(step) + ").\n";
      }
      if (chance(0.08) && !exogenous_.empty())
      {
        text += "hpd(" + ground(pick(exogenous_)) + ", " + std::to_string(step) + ").\n";
      }
    }
    const int records = between(0, size_.max_records);
    for (int i = 0; i < records; ++i)
    {
      text += !heads_.empty() && chance(0.3)       ? surprise(steps)
              : !exogenous_.empty() && chance(0.2) ? change(steps)
                                                   : observation(steps);
      text += chance(0.15) ? " [0." + std::to_string(between(4, 9)) + "].\n" : ".\n";
    }
    return text;
  }

  ReasonerOptions options()
  {
    ReasonerOptions options;
    options.diagnose_exogenous = chance(0.5);
    options.exception_weight = between(1, 2);
    options.exogenous_weight = between(1, 2);
    if (chance(0.2))
    {
      options.default_weights["d0"] = between(1, 3);
    }
    return options;
  }

private:
  // ---- Records ----

  /// The head of a default seen to be false, after the initial state.
  std::string surprise(int steps)
  {
    std::string head = pick(heads_);
    for (const char* variable : {"X", "Y"})
    {
      const std::size_t at = head.find(std::string("(") + variable + ")");
      if (at != std::string::npos)
      {
        head.replace(at + 1, 1, pick(things_));
      }
    }
    return "obs(" + head + ", " + (chance(0.9) ? "false" : "true") + ", " +
           std::to_string(between(1, std::max(1, steps))) + ")";
  }

  /// A fluent that has not the value it had.
  std::string change(int steps)
  {
    const Symbol& symbol = pick(inertial_);
    const std::string literal =
        ground(symbol) + (symbol.value_sort.empty() ? "" : " = " + constant(symbol.value_sort));
    const bool before = chance(0.5);
    return "obs(" + literal + (before ? ", true" : ", false") + ", 0).\nobs(" + literal +
           (before ? ", false, " : ", true, ") + std::to_string(between(1, std::max(1, steps))) +
           ")";
  }

  /// Something that mostly agrees with the other observations: they tell of one unchanging world.
  std::string observation(int steps)
  {
    const Symbol& symbol = chance(0.12) && !defined_.empty()   ? pick(defined_)
                           : chance(0.04) && !statics_.empty() ? pick(statics_)
                                                               : pick(inertial_);
    const bool initial = chance(0.4);
    std::string literal = ground(symbol);
    const std::string drawn =
        symbol.value_sort.empty() ? (chance(0.5) ? "true" : "false") : constant(symbol.value_sort);
    const std::string now = truth_.emplace(literal, drawn).first->second;
    const std::string known = chance(0.85) ? now : drawn;
    bool is = true;
    if (!symbol.value_sort.empty())
    {
      const std::string said = chance(0.6) ? known : constant(symbol.value_sort);
      const bool equal = chance(0.8);
      literal += (equal ? " = " : " != ") + said;
      is = (said == known) == equal;
    }
    else
    {
      const bool negative = chance(0.15);
      literal = (negative ? "-" : "") + literal;
      is = (known == "true") != negative;
    }
    const std::string value = is ? "true" : "false";
    return initial
               ? "init(" + literal + ", " + value + ")"
               : "obs(" + literal + ", " + value + ", " + std::to_string(between(0, steps)) + ")";
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

  // ---- Axioms ----

  std::string axioms()
  {
    std::string text;
    for (const std::vector<Symbol>* actions : {&agent_, &exogenous_})
    {
      for (const Symbol& action : *actions)
      {
        const int laws = between(1, 2);
        for (int i = 0; i < laws; ++i)
        {
          text += "  " + law(action) + ".\n";
        }
        if (chance(0.5))
        {
          std::set<std::string> bound;
          const std::string head = atom(action, bound, true);
          text += "  impossible " + head + ifText(body(between(1, 2), bound, true)) + ".\n";
        }
      }
    }
    if (chance(0.3))
    {
      text += "  impossible A, B if A != B.\n";
    }
    else if (agent_.size() > 1 && chance(0.4))
    {
      std::set<std::string> bound;
      const std::string first = atom(agent_[0], bound, true);
      const std::string second = atom(agent_[1], bound, true);
      text += "  impossible " + first + ", " + second + ifText(body(1, bound, true)) + ".\n";
    }
    else if (chance(0.15))
    {
      std::set<std::string> bound;
      text += "  impossible A" + ifText(body(2, bound, true)) + ".\n";
    }
    return text + constraints() + definitions();
  }

  std::string law(const Symbol& action)
  {
    std::set<std::string> bound;
    const std::string head = atom(action, bound, true);
    const Strings conditions = chance(0.6) ? Strings{} : body(between(1, 2), bound, true);
    const int outcomes = chance(0.25) ? 2 : 1;
    Strings texts;
    for (int i = 0; i < outcomes; ++i)
    {
      std::string text = i > 0 && chance(0.5) ? "nothing" : effect(bound);
      if (text != "nothing" && chance(0.15))
      {
        text += ", " + effect(bound);
      }
      texts.push_back(text + (outcomes > 1 ? " [o" + std::to_string(i) + "]" : ""));
    }
    return head + " causes " + joined(texts, " or ") + ifText(conditions);
  }

  std::string effect(std::set<std::string>& bound)
  {
    const Symbol& symbol = pick(inertial_);
    std::set<std::string> here = bound;
    const std::string text = atom(symbol, here, true);
    if (symbol.value_sort.empty())
    {
      return (chance(0.35) ? "-" : "") + text;
    }
    if (symbol.value_sort == "place" && chance(0.25))
    {
      const bool has_home = std::any_of(statics_.begin(), statics_.end(),
                                        [](const Symbol& each) { return each.name == "home"; });
      Strings choices = {"Z != " + constant("place"), text + " != Z"};
      if (symbol.name == "at")
      {
        choices.push_back("at(" + constant("thing") + ") = Z");
      }
      if (has_home)
      {
        choices.emplace_back("home(W) = Z");
      }
      return text + " = {Z : " + pick(choices) + "}";
    }
    return text + " = " + term(symbol.value_sort, here, false);
  }

  std::string constraints()
  {
    std::string text;
    const int count = between(0, 2);
    for (int i = 0; i < count; ++i)
    {
      std::set<std::string> bound;
      if (heads_.size() > 1 && chance(0.4))
      {
        const Strings others = body(chance(0.3) ? 1 : 0, bound, true);
        text += "  " + rivalry() + (others.empty() ? "" : ", " + others[0]) + ".\n";
        continue;
      }
      const bool has_at = std::any_of(inertial_.begin(), inertial_.end(),
                                      [](const Symbol& each) { return each.name == "at"; });
      if (has_at && chance(0.15))
      {
        // What rests on the values that its own head rules out.
        const Strings others = body(1, bound, true);
        text += "  at(X) = " + pick(places_) + " if at(X) != " + pick(places_) + ", " + others[0] +
                ".\n";
        continue;
      }
      const Strings conditions = body(between(1, 3), bound, true);
      std::set<std::string> known = bound;
      known.insert("X");
      const std::string head =
          chance(0.35) ? "false" : literal(pick(inertial_), known, false, 0.35);
      text += "  " + head + ifText(conditions) + ".\n";
    }
    return text;
  }

  /// A constraint under which two heads of defaults exclude each other, or one follows.
  std::string rivalry()
  {
    const std::string one = pick(heads_);
    const std::string other = pick(heads_);
    return chance(0.6)   ? "false if " + one + ", " + other
           : chance(0.8) ? contraryText(one) + " if " + other
                         : one + " if " + other;
  }

  /// Definitions look at defined fluents that come before only, or at their own, without `-`.
  std::string definitions()
  {
    std::string text;
    for (const Symbol& symbol : defined_)
    {
      std::set<std::string> bound;
      const std::string head = symbol.sorts.empty() ? symbol.name : symbol.name + "(X)";
      text += "  " + head + ifText(body(between(1, 2), bound, false)) + ".\n";
      if (symbol.name == "busy" && defined_.size() > 1 && chance(0.5))
      {
        text += std::string("  busy if ") + (chance(0.4) ? "-" : "") + "seen(" + constant("thing") +
                ").\n";
      }
      if (symbol.name == "seen" && chance(0.5))
      {
        const bool near = std::any_of(statics_.begin(), statics_.end(),
                                      [](const Symbol& each) { return each.name == "near"; });
        std::set<std::string> step = {"X"};
        text += near ? "  seen(X) if seen(Y), near(Y, X).\n"
                     : "  seen(X) if seen(Y), " + literal(pick(inertial_), step, true, 0.3) + ".\n";
      }
    }
    return text;
  }

  // ---- Defaults ----

  std::string defaults()
  {
    std::string text;
    Strings names;
    Strings heads;
    for (std::size_t i = 0; i < heads_.size(); ++i)
    {
      const std::string& head = heads_[i];
      std::set<std::string> bound;
      if (head.find("(X)") != std::string::npos)
      {
        bound.insert("X");
      }
      Strings conditions;
      if (!heads.empty() && chance(0.5))
      {
        conditions.push_back(pick(heads));
        if (conditions.back().find("(X)") != std::string::npos)
        {
          bound.insert("X");
        }
      }
      const Strings more = body(between(0, 2), bound, true);
      conditions.insert(conditions.end(), more.begin(), more.end());
      const bool has_x = bound.count("X") > 0;
      const std::string name = "d" + std::to_string(i) + (has_x ? "(X)" : "");
      text += "  " + name + ": " + head + ifText(conditions) + ".\n";
      names.push_back(name);
      heads.push_back(head);
      heads.push_back(contraryText(head));
    }
    for (std::size_t i = 0; i + 1 < names.size(); ++i)
    {
      for (std::size_t j = i + 1; j < names.size(); ++j)
      {
        if (chance(0.5))
        {
          const bool forward = chance(0.9);
          text += "  prefer " + names[forward ? j : i] + " over " + names[forward ? i : j] + ".\n";
        }
      }
    }
    return text;
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

}  // namespace

RandomCase randomCase(std::uint64_t seed, const CaseSize& size)
{
  constexpr int kMaxAttempts = 100;
  std::string last;
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt)
  {
    // Sorts are drawn independently of what stands where, so that the language refuses a few.
    std::seed_seq mixed{seed, seed >> 32U, static_cast<std::uint64_t>(attempt)};
    std::vector<std::uint32_t> words(2);
    mixed.generate(words.begin(), words.end());
    Writer writer((static_cast<std::uint64_t>(words[0]) << 32U) | words[1], size);
    RandomCase drawn{seed, writer.description(), writer.history(), writer.options()};
    try
    {
      const Description description = parseDescription(drawn.description, "random");
      static_cast<void>(parseHistory(drawn.history, "history", description));
      return drawn;
    }
    catch (const InvalidArgument& e)
    {
      last = std::string(e.what()) + "\n" + drawn.description;
    }
  }
  throw InternalError("no description of seed " + std::to_string(seed) + " is accepted: " + last);
}

std::string toString(const RandomCase& random_case)
{
  const ReasonerOptions& options = random_case.options;
  std::string weights;
  for (const auto& [name, weight] : options.default_weights)
  {
    weights += ", weight of " + name + " " + std::to_string(weight);
  }
  return "% seed " + std::to_string(random_case.seed) + "\n" + random_case.description +
         "% ---- history (" + (options.diagnose_exogenous ? "exogenous from the start, " : "") +
         "weight of an exception " + std::to_string(options.exception_weight) +
         ", of an exogenous action " + std::to_string(options.exogenous_weight) + weights +
         ") ----\n" + random_case.history;
}

}  // namespace kr3::reasoner
