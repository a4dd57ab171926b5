#include "kr3_executive/mission_script.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <kr3_common/error.hpp>

#include "kr3_executive/low_level_task.hpp"
#include "kr3_executive/rule_interpreter.hpp"
#include "literal_text.hpp"
#include "record_reader.hpp"
#include "yaml_reader.hpp"

namespace kr3::executive
{
namespace
{

const std::set<std::string> kKeys{
    "name",    "recovery",      "domain", "bindings",        "components_per_whole", "goal",
    "seed",    "noise",         "limits", "initial_records", "further_records",      "true",
    "notices", "interventions", "expect"};
const std::string kMore = "...";
const std::set<std::string> kResults{"achieved", "refuted", "displaced", "unresolved"};

/// Reads the parts of a script that need its domain.
class ScriptReader
{
public:
  ScriptReader(const std::string& text, const std::string& file,
               const refinement::LowLevelDomain& domain)
    : reader_(text, file), file_(file), domain_(domain)
  {
    actions_ = allInstances(domain.description());
    high_level_actions_ = allInstances(domain.highLevel());
  }

  MissionScript read()
  {
    const YAML::Node& root = reader_.root();
    reader_.checkKeys(root, kKeys);
    MissionScript script;
    script.name = reader_.text(root, "name");
    script.recovery = reader_.optionalText(root, "recovery");
    script.goal = reader_.text(root, "goal");
    if (!script.goal.empty())
      checked(root["goal"],
              [&] { static_cast<void>(reasoner::parseGoal(script.goal, domain_.highLevel())); });
    script.seed = count(root, "seed", 1);
    script.noise = reader_.truth(root, "noise", false);
    if (root["limits"])
      script.limits = limits(root["limits"]);
    if (root["initial_records"])
    {
      script.initial_records.emplace();
      for (const auto& node : items(root, "initial_records"))
        script.initial_records->push_back(readRecord(reader_, node, domain_.highLevel()));
    }
    for (const auto& node : items(root, "further_records"))
      script.further_records.push_back(readRecord(reader_, node, domain_.highLevel()));
    for (const auto& node : items(root, "true"))
    {
      if (!change(node).fluent.empty())
        script.truths.push_back(node.as<std::string>());
    }
    for (const auto& node : items(root, "notices"))
      script.notices.push_back(notice(node));
    for (const auto& node : items(root, "interventions"))
      script.interventions.push_back(intervention(node));
    if (root["expect"])
      script.expect = expectations(root["expect"]);
    else
      reader_.problem(root, "no 'expect'");
    reader_.finish();
    return script;
  }

private:
  static std::vector<std::string> allInstances(const reasoner::Description& description)
  {
    const RuleInterpreter laws(description);
    std::vector<std::string> texts;
    for (const auto& declaration : description.actions)
    {
      if (declaration.exogenous)
        continue;
      for (const auto& action : laws.instances(declaration))
        texts.push_back(reasoner::toString(action));
    }
    return texts;
  }

  template <typename Check>
  void checked(const YAML::Node& node, const Check& check)
  {
    try
    {
      check();
    }
    catch (const InvalidArgument& e)
    {
      reader_.problem(node, e.what());
    }
  }

  /// The items of a list; a problem when it is something else.
  std::vector<YAML::Node> items(const YAML::Node& map, const std::string& key)
  {
    if (!map.IsMap() || !map[key])
      return {};
    if (!map[key].IsSequence())
    {
      reader_.problem(map[key], "'" + key + "' is no list");
      return {};
    }
    return {map[key].begin(), map[key].end()};
  }

  std::uint32_t count(const YAML::Node& map, const std::string& key, std::uint32_t fallback)
  {
    const double value = reader_.number(map, key, fallback);
    if (value >= 0.0 && value == std::floor(value) &&
        value <= std::numeric_limits<std::uint32_t>::max())
      return static_cast<std::uint32_t>(value);
    reader_.problem(map[key], "'" + key + "' is no count");
    return fallback;
  }

  Limits limits(const YAML::Node& node)
  {
    Limits limits;
    reader_.checkKeys(node, {"max_hl_actions", "max_ll_actions", "max_attempts", "max_reopened"});
    limits.max_hl_actions = count(node, "max_hl_actions", limits.max_hl_actions);
    limits.max_ll_actions = count(node, "max_ll_actions", limits.max_ll_actions);
    limits.max_attempts = count(node, "max_attempts", limits.max_attempts);
    limits.max_reopened = count(node, "max_reopened", limits.max_reopened);
    return limits;
  }

  /// `f = v` or `f` or `-f` of the low level, or of the high level with any component of v.
  WorldChange change(const YAML::Node& node)
  {
    if (!node.IsScalar())
    {
      reader_.problem(node, "expected a literal");
      return {};
    }
    const auto text = node.as<std::string>();
    for (const auto* level : {&domain_.description(), &domain_.highLevel()})
    {
      try
      {
        const reasoner::Literal literal = reasoner::parseGroundLiteral(text, *level);
        if (!literal.equal)
        {
          reader_.problem(node, "'" + text + "', expected a literal that gives a value");
          return {};
        }
        const auto fluent = reasoner::toString(literal.atom);
        const auto* declared = domain_.description().findFluent(literal.atom.name);
        if (declared == nullptr || declared->kind != reasoner::FluentKind::kInertial)
        {
          reader_.problem(node, "'" + fluent + "' is no inertial fluent");
          return {};
        }
        for (const auto& argument : literal.atom.arguments)
        {
          if (!domain_.isMagnified(argument.name))
            continue;
          reader_.problem(node, "'" + argument.name + "' has components, expected one of them");
          return {};
        }
        return {fluent, domain_.components(literal.value.name)};
      }
      catch (const InvalidArgument& e)
      {
        if (level == &domain_.highLevel())
          reader_.problem(node, e.what());
      }
    }
    return {};
  }

  std::vector<WorldChange> changes(const YAML::Node& map, const std::string& key)
  {
    std::vector<WorldChange> all;
    for (const auto& node : items(map, key))
      all.push_back(change(node));
    return all;
  }

  reasoner::Literal lowLevelLiteral(const YAML::Node& node)
  {
    reasoner::Literal literal;
    checked(node, [&] {
      literal = reasoner::parseGroundLiteral(node.as<std::string>(), domain_.description());
    });
    return literal;
  }

  double confidence(const YAML::Node& node)
  {
    const double value = reader_.number(node, "confidence", 1.0);
    if (!(value > 0.0 && value <= 1.0))
      reader_.problem(node, "confidence outside (0, 1]");
    return value;
  }

  void checkPattern(const YAML::Node& node, const std::string& pattern,
                    const std::vector<std::string>& actions)
  {
    const bool any = std::any_of(actions.begin(), actions.end(), [&](const auto& action) {
      return matchesPattern(action, pattern);
    });
    if (!any)
      reader_.problem(node, "'" + pattern + "' matches no action");
  }

  Trigger trigger(const YAML::Node& node)
  {
    Trigger when;
    reader_.checkKeys(node, {"action", "high_level", "if", "number", "occurrence", "times"});
    if (node["action"])
      checkPattern(node["action"], when.action = reader_.text(node, "action"), actions_);
    if (node["high_level"])
      checkPattern(node["high_level"], when.high_level = reader_.text(node, "high_level"),
                   high_level_actions_);
    for (const auto& condition : items(node, "if"))
      when.conditions.push_back(lowLevelLiteral(condition));
    when.number = count(node, "number", 0);
    when.occurrence = count(node, "occurrence", 1);
    if (when.occurrence == 0)
      reader_.problem(node["occurrence"], "'occurrence' counts from 1");
    when.times = node["times"] && node["times"].Scalar() == "always" ? 0 : count(node, "times", 1);
    return when;
  }

  Happening happening(const YAML::Node& node)
  {
    Happening happening;
    reader_.checkKeys(node, {"set", "tell", "sightings"});
    happening.set = changes(node, "set");
    for (const auto& told : items(node, "tell"))
    {
      reader_.checkKeys(told, {"statement", "value", "confidence"});
      reasoner::Record record;
      record.statement = reader_.text(told, "statement");
      record.value = reader_.truth(told, "value", true);
      record.confidence = confidence(told);
      record.source = "person";
      checked(told, [&] {
        static_cast<void>(reasoner::parseGroundLiteral(record.statement, domain_.highLevel()));
      });
      happening.tell.push_back(std::move(record));
    }
    return happening;
  }

  ForcedResult forced(const YAML::Node& node, const std::string& pattern)
  {
    ForcedResult force;
    reader_.checkKeys(node, {"outcome", "blocked", "unavailable", "becomes", "observe"});
    if (node["outcome"])
      force.outcome = reader_.text(node, "outcome");
    force.blocked = reader_.truth(node, "blocked", false);
    force.unavailable = reader_.truth(node, "unavailable", false);
    force.becomes = changes(node, "becomes");
    force.observation = reader_.texts(node["observe"]);
    for (const auto& text : actions_)
    {
      const LiteralText action = takeApart(text);
      if (!matchesPattern(text, pattern))
        continue;
      const auto laws =
          observedFluents(domain_.description(), {text, action.symbol, action.arguments});
      if (!force.observation.empty() && laws.size() != force.observation.size())
      {
        reader_.problem(node["observe"], std::to_string(force.observation.size()) +
                                             " values, expected " + std::to_string(laws.size()) +
                                             ", one for each observation law of " + action.symbol);
      }
      if (force.outcome && !force.blocked && !hasOutcome(action.symbol, *force.outcome))
        reader_.problem(node["outcome"],
                        "'" + *force.outcome + "' is no outcome of " + action.symbol);
      break;
    }
    return force;
  }

  [[nodiscard]] bool hasOutcome(const std::string& symbol, const std::string& label) const
  {
    const auto& laws = domain_.description().causal_laws;
    return std::any_of(laws.begin(), laws.end(), [&](const auto& law) {
      return law.action.name == symbol &&
             std::any_of(law.outcomes.begin(), law.outcomes.end(),
                         [&](const auto& outcome) { return outcome.label == label; });
    });
  }

  Intervention intervention(const YAML::Node& node)
  {
    Intervention result;
    reader_.checkKeys(node, {"when", "before", "force", "after"});
    if (!node.IsMap())
      return result;
    result.place = file_ + ":" + std::to_string(node.Mark().line + 1);
    if (node["when"])
      result.when = trigger(node["when"]);
    else
      reader_.problem(node, "no 'when'");
    if (node["before"])
      result.before = happening(node["before"]);
    if (node["before"] && node["before"]["sightings"])
      reader_.problem(node["before"]["sightings"], "sightings come with a result, under 'after'");
    if (node["force"])
      result.force = forced(node["force"], result.when.action);
    if (node["after"])
    {
      result.after = happening(node["after"]);
      for (const auto& seen : items(node["after"], "sightings"))
      {
        reader_.checkKeys(seen, {"literal", "confidence"});
        const std::string text = reader_.text(seen, "literal");
        checked(seen, [&] {
          static_cast<void>(reasoner::parseGroundLiteral(text, domain_.description()));
        });
        result.sightings.emplace_back(text, confidence(seen));
      }
    }
    return result;
  }

  Notice notice(const YAML::Node& node)
  {
    reader_.checkKeys(node, {"after", "literal", "if", "confidence"});
    Notice notice;
    notice.after = reader_.text(node, "after");
    notice.literal = reader_.text(node, "literal");
    notice.confidence = confidence(node);
    notice.conditions = reader_.texts(node["if"]);
    const auto symbol = takeApart(notice.after).symbol;
    if (domain_.description().findAction(symbol) == nullptr)
      reader_.problem(node["after"], "'" + symbol + "' is no low-level action");
    const auto* fluent = domain_.description().findFluent(takeApart(notice.literal).symbol);
    if (fluent == nullptr)
      reader_.problem(node["literal"], "'" + notice.literal + "' is about no fluent");
    return notice;
  }

  ExpectedAction expectedAction(const YAML::Node& node)
  {
    ExpectedAction expected;
    if (!node.IsScalar())
    {
      reader_.problem(node, "expected \"action: result\" as one text");
      return expected;
    }
    const auto text = node.as<std::string>();
    const auto colon = text.rfind(": ");
    expected.action = text.substr(0, colon);
    checkPattern(node, expected.action, high_level_actions_);
    if (colon != std::string::npos && text.substr(colon + 2) != "*")
      expected.result = text.substr(colon + 2);
    if (!expected.result.empty() && kResults.count(expected.result) == 0)
      reader_.problem(node, "result '" + expected.result +
                                "', expected achieved, refuted, displaced or unresolved");
    return expected;
  }

  std::vector<std::string> patterns(const YAML::Node& map, const std::string& key)
  {
    std::vector<std::string> all;
    for (const auto& node : items(map, key))
    {
      all.push_back(node.Scalar());
      checkPattern(node, all.back(), actions_);
    }
    return all;
  }

  Expectations expectations(const YAML::Node& node)
  {
    Expectations expect;
    reader_.checkKeys(node, {"declared", "true", "reason", "high_level", "low_level", "never",
                             "history", "recorded", "not_recorded", "explanations", "reopened",
                             "taken_back", "max_low_level_actions"});
    if (!node.IsMap())
      return expect;
    if (node["declared"])
      expect.declared = reader_.truth(node, "declared", false);
    if (node["true"])
      expect.goal_true = reader_.truth(node, "true", false);
    if (node["reason"])
      expect.reason = reader_.text(node, "reason");
    if (node["high_level"])
    {
      expect.high_level.emplace();
      for (const auto& item : items(node, "high_level"))
      {
        if (expect.more_high_level)
          reader_.problem(item, "'...' is not the last one");
        if (item.IsScalar() && item.Scalar() == kMore)
          expect.more_high_level = true;
        else
          expect.high_level->push_back(expectedAction(item));
      }
    }
    expect.low_level = patterns(node, "low_level");
    expect.never = patterns(node, "never");
    if (node["history"])
      expect.history = reader_.texts(node["history"]);
    expect.recorded = reader_.texts(node["recorded"]);
    expect.not_recorded = reader_.texts(node["not_recorded"]);
    if (node["explanations"])
    {
      expect.explanations.emplace();
      for (const auto& item : items(node, "explanations"))
        expect.explanations->push_back(reader_.texts(item));
    }
    if (node["reopened"])
      expect.reopened = count(node, "reopened", 0);
    if (node["taken_back"])
      expect.taken_back = reader_.texts(node["taken_back"]);
    if (node["max_low_level_actions"])
      expect.max_low_level_actions = count(node, "max_low_level_actions", 0);
    return expect;
  }

  YamlReader reader_;
  std::string file_;
  const refinement::LowLevelDomain& domain_;
  std::vector<std::string> actions_;
  std::vector<std::string> high_level_actions_;
};

}  // namespace

bool matchesPattern(const std::string& text, const std::string& pattern)
{
  // Greedy from the last star on: enough for this kind of pattern.
  std::size_t t = 0;
  std::size_t p = 0;
  std::size_t star = std::string::npos;
  std::size_t resumed = 0;
  while (t < text.size())
  {
    if (p < pattern.size() && pattern[p] == '*')
    {
      star = p++;
      resumed = t;
    }
    else if (p < pattern.size() && pattern[p] == text[t])
    {
      ++p;
      ++t;
    }
    else if (star != std::string::npos)
    {
      p = star + 1;
      t = ++resumed;
    }
    else
      return false;
  }
  while (p < pattern.size() && pattern[p] == '*')
    ++p;
  return p == pattern.size();
}

ScriptHeader readScriptHeader(const std::string& path)
{
  YamlReader reader(readTextFile(path), path);
  ScriptHeader header;
  header.domain = reader.text(reader.root(), "domain");
  header.bindings = reader.optionalText(reader.root(), "bindings");
  const double components = reader.number(reader.root(), "components_per_whole", 3.0);
  if (!(components >= 1.0 && components <= 100.0) || components != std::floor(components))
    reader.problem(reader.root()["components_per_whole"],
                   "'components_per_whole' is no number from 1 to 100");
  reader.finish();
  header.components_per_whole = static_cast<std::size_t>(components);
  return header;
}

MissionScript readScript(const std::string& path, const refinement::LowLevelDomain& domain)
{
  return parseScript(readTextFile(path), path, domain);
}

MissionScript parseScript(const std::string& text, const std::string& file,
                          const refinement::LowLevelDomain& domain)
{
  return ScriptReader(text, file, domain).read();
}

}  // namespace kr3::executive
