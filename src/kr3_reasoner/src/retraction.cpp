#include "retraction.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "text.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

namespace
{

constexpr std::size_t kMaxTries = 24;

/// The records that the cheapest model gives up; nothing when there is no
/// model.
std::optional<std::vector<std::size_t>> cheapest(Solver& solver)
{
  std::optional<std::vector<std::size_t>> wrong;
  solver.solve([&](const Clingo::Model& model) {
    wrong.emplace();
    for (const Clingo::Symbol& symbol : model.symbols(Clingo::ShowType::Shown))
    {
      if (symbol.match("ab", 1) && symbol.arguments()[0].match("wrong", 1))
      {
        wrong->push_back(static_cast<std::size_t>(symbol.arguments()[0].arguments()[0].number()));
      }
    }
    std::sort(wrong->begin(), wrong->end());
    return true;
  });
  return wrong;
}

/// Rules out a set, and what contains it if `supersets`.
std::string blocked(const std::vector<std::size_t>& set, bool supersets)
{
  std::string text = ":- #true";
  std::string members;
  for (const std::size_t record : set)
  {
    text += ", ab(wrong(" + std::to_string(record) + "))";
    members += ", _R != " + std::to_string(record);
  }
  if (!supersets)
  {
    text += ", not 1 { ab(wrong(_R)) : abducible(wrong(_R))" + members + " }";
  }
  return text + ".\n";
}

}  // namespace

std::vector<std::vector<std::size_t>> retractionSets(
    const Description& description, const HistoryProgram& program,
    const std::vector<CheckedRecord>& records, int current_step,
    const std::vector<Literal>& excluded, int step, bool exogenous, std::size_t max_sets,
    const std::function<bool(const std::vector<std::size_t>&)>& accept)
{
  const Encoding encoding(description);
  Solver solver({"0", "--opt-strategy=usc", "--warn=none"}, program.limit());
  program.addTo(solver);
  std::string wanted = ":- ab(wrong(_R)), _R < 0.\n";  // what is no longer kept stays
  for (const Literal& literal : excluded)
  {
    wanted += ":- " + encoding.literal(literal, std::to_string(step)) + ".\n";
  }
  solver.add("wanted", {}, wanted);
  program.groundHistory(solver, records, current_step, {exogenous, true});
  solver.ground({{"minimize", {}}, {"wanted", {}}});
  std::vector<std::vector<std::size_t>> sets;
  for (std::size_t i = 0; i < kMaxTries && sets.size() < max_sets; ++i)
  {
    const auto wrong = cheapest(solver);
    if (!wrong)
    {
      break;
    }
    const bool accepted = accept(*wrong);
    if (accepted)
    {
      sets.push_back(*wrong);
    }
    if (accepted && wrong->empty())
    {
      break;
    }
    const std::string part = "blocked" + std::to_string(i);
    solver.add(part, {}, blocked(*wrong, accepted));
    solver.ground({{part, {}}});
  }
  return sets;
}

bool contradicts(const Literal& recorded, const Literal& wanted)
{
  if (toString(recorded.atom) != toString(wanted.atom))
  {
    return false;
  }
  const bool same_value = recorded.value.name == wanted.value.name;
  return wanted.equal ? recorded.equal != same_value : recorded.equal && same_value;
}

Retraction retractionOf(const std::vector<Record>& history, std::vector<std::size_t> records,
                        std::string opens)
{
  constexpr double kScale = 100.0;
  Retraction retraction;
  retraction.records = std::move(records);
  retraction.opens = std::move(opens);
  std::vector<std::string> texts;
  for (const std::size_t i : retraction.records)
  {
    retraction.log_odds += doubtOf(history[i]) / kScale;
    texts.push_back(withPlace(history[i]));
  }
  retraction.in_words =
      (retraction.opens.empty() ? "the history is consistent" : retraction.opens + " is possible") +
      (texts.empty() ? std::string(" as it is") : " without the record " + listed(texts));
  return retraction;
}

}  // namespace kr3::reasoner
