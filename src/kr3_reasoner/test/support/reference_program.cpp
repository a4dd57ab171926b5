#include "reference_program.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace kr3::reasoner::oracle
{

namespace
{

/// Writes the program. Fluents, actions, defaults, laws and records go by their numbers.
class Program
{
public:
  Program(const GroundDomain& domain, const Description& description,
          const std::vector<Record>& records, const ReasonerOptions& options, const Level& level)
    : domain_(domain)
    , description_(description)
    , records_(records)
    , options_(options)
    , level_(level)
  {
    for (const Record& record : records)
    {
      last_ = std::max(last_, record.step + (isAction(record) ? 1 : 0));
    }
  }

  std::string text()
  {
    out_ << "step(0.." << last_ << ").\n";
    declare();
    closure();
    preferences();
    for (const GroundConstraint& constraint : domain_.constraints)
    {
      rule(constraint.head ? at(*constraint.head, "T") : "",
           "step(T)" + body(constraint.body, "T"));
    }
    out_ << "holds(F,V,T+1) :- holds(F,V,T), inertial(F), step(T), T < " << last_
         << ", not -holds(F,V,T+1).\n"
         << "-holds(F,V,T+1) :- -holds(F,V,T), inertial(F), step(T), T < " << last_
         << ", not holds(F,V,T+1).\n"
         << "-holds(F,V,T) :- defined(F), value(F,V), step(T), not holds(F,V,T).\n"
         << "-holds(F,V,T) :- holds(F,W,T), value(F,V), V != W.\n"
         << ":- functional(F), step(T), not 1 { holds(F,V,T) : value(F,V) } 1.\n";
    for (std::size_t i = 0; i < domain_.laws.size(); ++i)
    {
      law(i);
    }
    executabilities();
    history();
    out_ << ":~ price(X,P), assumed(X). [P@1,X]\n:~ doubt(X,P), assumed(X). [P@2,X]\n"
         << "#defined price/2. #defined doubt/2. #defined assumed/1. #defined occ/2. #defined "
            "imp/2.\n"
         << "#defined free/2. #defined blocked/1. #defined clash/1. #defined functional/1.\n"
         << "#defined defined/1. #defined inertial/1. #defined w/3. #defined wn/3. #defined e/1.\n"
         << "#show holds/3. #show assumed/1.\n";
    return out_.str();
  }

private:
  static bool isAction(const Record& record)
  {
    return record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
  }

  void rule(const std::string& head, const std::string& body)
  {
    out_ << head << " :- " << (body.rfind(", ", 0) == 0 ? body.substr(2) : body) << ".\n";
  }

  /// The sign and arguments of a literal; `-p` of a boolean fluent is the negation of p = 1.
  [[nodiscard]] std::pair<bool, std::string> parts(const GroundLiteral& literal) const
  {
    const bool boolean = domain_.fluents[static_cast<std::size_t>(literal.fluent)].boolean;
    const bool positive = boolean ? literal.value == 1 : literal.equal;
    return {positive,
            std::to_string(literal.fluent) + "," + (boolean ? "1" : std::to_string(literal.value))};
  }

  [[nodiscard]] std::string at(const GroundLiteral& literal, const std::string& step) const
  {
    const auto [positive, pair] = parts(literal);
    return (positive ? "holds(" : "-holds(") + pair + "," + step + ")";
  }
  [[nodiscard]] std::string known(const GroundLiteral& literal) const
  {
    const auto [positive, pair] = parts(literal);
    return (positive ? "u(" : "-u(") + pair + ")";
  }
  [[nodiscard]] std::string on(const GroundLiteral& literal, const std::string& layer) const
  {
    const auto [positive, pair] = parts(literal);
    return (positive ? "w(" : "wn(") + layer + "," + pair + ")";
  }
  [[nodiscard]] std::string body(const GroundBody& literals, const std::string& step) const
  {
    std::string text;
    for (const GroundLiteral& literal : literals)
    {
      text += ", " + at(literal, step);
    }
    return text;
  }

  void declare()
  {
    for (std::size_t f = 0; f < domain_.fluents.size(); ++f)
    {
      const GroundFluentInfo& fluent = domain_.fluents[f];
      out_ << (fluent.defined ? "defined(" : "inertial(") << f << "). ";
      if (fluent.boolean)
      {
        out_ << "value(" << f << ",1).\n";
      }
      else
      {
        out_ << "functional(" << f << "). value(" << f << ",0.." << fluent.values.size() - 1
             << ").\n";
      }
    }
    out_ << "1 { holds(F,V,0); -holds(F,V,0) } 1 :- inertial(F), value(F,V).\n"
         << ":- u(F,V), not holds(F,V,0). :- -u(F,V), not -holds(F,V,0).\n"
         << "-u(F,V) :- u(F,W), value(F,V), V != W.\n";
  }

  void closure()
  {
    std::set<std::string> heads;
    for (std::size_t d = 0; d < domain_.defaults.size(); ++d)
    {
      const GroundDefault& rule_d = domain_.defaults[d];
      std::string conditions;
      for (const GroundLiteral& literal : rule_d.body)
      {
        conditions += ", " + known(literal);
      }
      rule("body(" + std::to_string(d) + ")", "#true" + conditions);
      rule("out(" + std::to_string(d) + ")", known(contrary(rule_d.head, domain_)));
      for (const auto& [better, worse] : domain_.better)
      {
        if (worse == static_cast<int>(d))
        {
          conditions += ", free(" + std::to_string(d) + "," + std::to_string(better) + ")";
        }
      }
      rule(known(rule_d.head),
           "#true" + conditions + ", not " + known(contrary(rule_d.head, domain_)));
      // Exceptions: by the number of the first default with that head.
      const std::string head = known(rule_d.head);
      const auto weight = options_.default_weights.find(rule_d.name);
      const int price =
          weight == options_.default_weights.end() ? options_.exception_weight : weight->second;
      const std::string exception = "e(" + std::to_string(exceptionOf(rule_d.head)) + ")";
      if (heads.insert(head).second)
      {
        out_ << "{ assumed(" << exception << ") }.\n";
        rule(known(contrary(rule_d.head, domain_)), "assumed(" + exception + ")");
      }
      out_ << "offer(" << exception << "," << price << ").\n";
    }
    out_ << "price(X,P) :- offer(X,_), P = #min { Q : offer(X,Q) }.\n#defined offer/2.\n";
    for (const GroundConstraint& constraint : domain_.constraints)
    {
      if (constraint.head)
      {
        std::string conditions;
        for (const GroundLiteral& literal : constraint.body)
        {
          conditions += ", " + known(literal);
        }
        rule(known(*constraint.head), "#true" + conditions);
      }
    }
  }

  [[nodiscard]] std::size_t exceptionOf(const GroundLiteral& head) const
  {
    std::size_t d = 0;
    while (known(domain_.defaults[d].head) != known(head))
    {
      ++d;
    }
    return d;
  }

  void preferences()
  {
    if (domain_.better.empty())
    {
      return;
    }
    // One layer for each default and each pair: what is known without defaults, and their heads.
    std::set<std::vector<int>> layers;
    for (const auto& [better, worse] : domain_.better)
    {
      layers.insert({{better}, {worse}, {better, worse}});
      const std::string b = std::to_string(better);
      const std::string d = std::to_string(worse);
      const std::string free = "free(" + d + "," + b + ")";
      rule("rivals(" + b + "," + d + ")",
           "clash(l(" + b + "," + d + ")), not clash(l(" + b + ")), not clash(l(" + d + "))");
      rule(free, "not rivals(" + b + "," + d + ")");
      rule(free, "not body(" + b + ")");
      rule(free, "out(" + b + ")");
      rule(free, "blocked(" + b + ")");
      rule("blocked(" + d + ")", "not " + free);
    }
    out_ << "#defined rivals/2.\n";
    for (const std::vector<int>& layer : layers)
    {
      const std::string name = "l(" + std::to_string(layer[0]) +
                               (layer.size() > 1 ? "," + std::to_string(layer[1]) : "") + ")";
      out_ << "layer(" << name << ").\n";
      for (const int d : layer)
      {
        out_ << on(domain_.defaults[static_cast<std::size_t>(d)].head, name) << ".\n";
      }
    }
    for (const GroundConstraint& constraint : domain_.constraints)
    {
      std::string conditions = "layer(L)";
      for (const GroundLiteral& literal : constraint.body)
      {
        conditions += ", " + on(literal, "L");
      }
      rule(constraint.head ? on(*constraint.head, "L") : "clash(L)", conditions);
    }
    out_ << "wn(L,F,V) :- w(L,F,W), value(F,V), V != W.\nclash(L) :- w(L,F,V), wn(L,F,V).\n"
         << "w(L,F,V) :- layer(L), given(F,V). wn(L,F,V) :- layer(L), denied(F,V).\n"
         << "#defined given/2. #defined denied/2.\n";
    for (std::size_t d = 0; d < domain_.defaults.size(); ++d)
    {
      const auto [positive, pair] = parts(contrary(domain_.defaults[d].head, domain_));
      rule((positive ? "given(" : "denied(") + pair + ")",
           "assumed(e(" + std::to_string(exceptionOf(domain_.defaults[d].head)) + "))");
    }
  }

  void law(std::size_t index)
  {
    const GroundLaw& instance = domain_.laws[index];
    const std::string i = std::to_string(index);
    for (const GroundBody& each : instance.bodies)
    {
      rule("fire(" + i + ",T)", "occ(" + std::to_string(instance.action) + ",T)" + body(each, "T"));
    }
    for (std::size_t o = 0; o < instance.outcomes.size(); ++o)
    {
      const std::string outcome = i + "," + std::to_string(o);
      std::string can;
      for (std::size_t j = 0; j < instance.outcomes[o].size(); ++j)
      {
        const GroundEffect& effect = instance.outcomes[o][j];
        const std::string part = outcome + "," + std::to_string(j);
        if (!effect.is_choice)
        {
          rule(at({effect.fluent, effect.value, true}, "T+1"), "out(" + outcome + ",T)");
          continue;
        }
        for (const GroundEffect::Candidate& candidate : effect.candidates)
        {
          const std::string value = std::to_string(candidate.value);
          for (const GroundBody& each : candidate.bodies)
          {
            rule("cand(" + part + "," + value + ",T)", "fire(" + i + ",T)" + body(each, "T"));
          }
          rule(at({effect.fluent, candidate.value, true}, "T+1"),
               "pick(" + part + "," + value + ",T)");
        }
        out_ << "1 { pick(" << part << ",V,T) : cand(" << part << ",V,T) } 1 :- out(" << outcome
             << ",T).\n#defined cand/5. #defined pick/5.\n";
        can += ", 1 { cand(" + part + ",V,T) }";
      }
      rule("can(" + outcome + ",T)", "fire(" + i + ",T)" + can);
    }
    out_ << "1 { out(" << i << ",O,T) : can(" << i << ",O,T) } 1 :- fire(" << i << ",T).\n";
  }

  void executabilities()
  {
    for (const GroundExecutability& each : domain_.executabilities)
    {
      std::string conditions;
      const std::set<int> actions(each.actions.begin(), each.actions.end());
      for (const int action : actions)
      {
        conditions += ", occ(" + std::to_string(action) + ",T)";
      }
      rule("", conditions + body(each.body, "T"));
      if (actions.size() == 1)
      {
        rule("imp(" + std::to_string(*actions.begin()) + ",T)", "step(T)" + body(each.body, "T"));
      }
    }
  }

  void history()
  {
    for (std::size_t i = 0; i < records_.size(); ++i)
    {
      const Record& record = records_[i];
      const std::string step = std::to_string(record.step);
      if (isAction(record))
      {
        const std::string pair = std::to_string(actionOf(record.statement, domain_)) + "," + step;
        const bool attempt = record.kind == RecordKind::kAttempted;
        rule("occ(" + pair + ")", attempt ? "not failed(" + pair + ")" : "#true");
        if (attempt)
        {
          out_ << "{ assumed(fail(" << pair << ")) } :- not imp(" << pair << ").\n"
               << "failed(" << pair << ") :- assumed(fail(" << pair << ")).\n"
               << "failed(" << pair << ") :- imp(" << pair << ").\n"
               << "price(fail(" << pair << ")," << options_.exogenous_weight << ").\n";
        }
        continue;
      }
      observation(record, std::to_string(i));
    }
    for (std::size_t a = 0; level_.exogenous && a < domain_.actions.size(); ++a)
    {
      if (domain_.actions[a].exogenous)
      {
        const std::string pair = std::to_string(a) + ",T";
        out_ << "{ assumed(exo(" << pair << ")) } :- step(T), T < " << last_ << ".\nocc(" << pair
             << ") :- assumed(exo(" << pair << ")).\nprice(exo(" << pair << "),"
             << options_.exogenous_weight << ") :- step(T).\n";
      }
    }
  }

  void observation(const Record& record, const std::string& number)
  {
    std::string holds = "#true";
    if (level_.retractions && record.confidence < 1.0)
    {
      const double odds = record.confidence / (1.0 - record.confidence);
      out_ << "{ assumed(wrong(" << number << ")) }. doubt(wrong(" << number << "),"
           << std::max(1L, std::lround(100.0 * std::log(odds))) << ").\n";
      holds = "not assumed(wrong(" + number + "))";
    }
    const Literal literal = parseGroundLiteral(record.statement, description_);
    auto ground = literalOf(literal, domain_);
    if (!ground)
    {
      if (staticHolds(literal, description_, domain_) != record.value)
      {
        rule("", holds);
      }
      return;
    }
    ground = record.value ? *ground : contrary(*ground, domain_);
    rule("", holds + ", not " + at(*ground, std::to_string(record.step)));
    if (record.step == 0)
    {
      rule(known(*ground), holds);
      const auto [positive, pair] = parts(*ground);
      rule((positive ? "given(" : "denied(") + pair + ")", holds);
    }
  }

  const GroundDomain& domain_;
  const Description& description_;
  const std::vector<Record>& records_;
  const ReasonerOptions& options_;
  Level level_;
  int last_ = 0;
  std::ostringstream out_;
};

}  // namespace

std::string referenceProgram(const GroundDomain& domain, const Description& description,
                             const std::vector<Record>& records, const ReasonerOptions& options,
                             const Level& level)
{
  return Program(domain, description, records, options, level).text();
}

}  // namespace kr3::reasoner::oracle
