#include "random_case.hpp"

#include <kr3_common/error.hpp>

#include "random_language.hpp"

namespace kr3::reasoner
{

namespace
{

/// Draws one description and history; the description may be one that the language refuses.
class Writer : private RandomLanguage
{
public:
  Writer(std::uint64_t seed, const CaseSize& size) : RandomLanguage(seed, size) {}

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
