#include "beginning.hpp"

#include "encoding.hpp"

namespace kr3::reasoner
{

namespace
{

std::string value(const Atom& fluent, const std::string& value, int step)
{
  return "h(" + Encoding::term(fluent) + "," + value + "," + std::to_string(step) + ")";
}

std::string componentRules(const BeginningComponent& component, const std::string& name,
                           const std::string& when, int first_step)
{
  std::string text;
  std::string all;
  std::size_t number = 0;
  for (const BeginningRow& row : component.rows)
  {
    for (const std::vector<std::size_t>& explanation : row.explanations)
    {
      const std::string chosen = "case(" + name + "," + std::to_string(number++) + ")";
      all += (all.empty() ? "" : "; ") + chosen;
      for (std::size_t i = 0; i < component.fluents.size(); ++i)
      {
        const OpenFluent& fluent = component.fluents[i];
        text += ":- " + chosen + ", not " +
                value(fluent.atom, fluent.values[row.values[i]], first_step) + ".\n";
      }
      for (const std::size_t assumed : explanation)
      {
        text += "ab(" + component.assumptions[assumed].what.to_string() + ") :- " + chosen + ".\n";
      }
    }
  }
  for (const CarriedAssumption& assumption : component.assumptions)
  {
    text += std::string(assumption.is_retraction ? "doubt(" : "weight(") +
            assumption.what.to_string() + "," + std::to_string(assumption.price) + ").\n";
  }
  return "1 { " + all + " } 1 :- " + when + ".\n" + text;
}

}  // namespace

int firstStepOf(const Beginning* beginning)
{
  return beginning == nullptr ? 0 : beginning->first_step;
}

const Record& recordOf(int number, const std::vector<CheckedRecord>& records,
                       const Beginning* beginning)
{
  return number < 0 ? beginning->retractable[static_cast<std::size_t>(-1 - number)].record
                    : records[static_cast<std::size_t>(number)].record;
}

std::string levelRules(const BeginningLevel& level, std::size_t number, const std::string& guard,
                       int first_step)
{
  const std::string when = "begun" + (guard.empty() ? "" : ", " + guard);
  if (!level.consistent)
  {
    return ":- " + when + ".\n";
  }
  std::string text;
  for (std::size_t i = 0; i < level.components.size(); ++i)
  {
    const std::string name = std::to_string(number) + "," + std::to_string(i);
    text += componentRules(level.components[i], name, when, first_step);
  }
  return text;
}

std::string factRules(const Beginning& beginning)
{
  std::string text;
  for (const Literal& fact : beginning.facts)
  {
    text += ":- begun, not " + value(fact.atom, fact.value.name, beginning.first_step) + ".\n";
  }
  return text;
}

}  // namespace kr3::reasoner
