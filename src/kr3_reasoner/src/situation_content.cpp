#include "situation_content.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace kr3::reasoner
{

namespace
{

// Without records that may be wrong there are these two kinds of explanation.
constexpr std::array<bool, 2> kExogenous{false, true};

bool isWord(char c)
{
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

void append(std::vector<std::string>& tokens, const Atom& atom)
{
  tokens.push_back(atom.name);
  for (const Term& argument : atom.arguments)
  {
    tokens.emplace_back(",");
    tokens.push_back(argument.name);
  }
}

int priceOf(const BeginningRow& row, const BeginningComponent& component)
{
  const auto& explanation = row.explanations.front();
  return std::accumulate(explanation.begin(), explanation.end(), 0, [&](int sum, std::size_t i) {
    return sum + component.assumptions[i].price;
  });
}

std::string joined(const std::vector<std::string>& tokens)
{
  std::string text;
  for (const std::string& token : tokens)
  {
    text += token;
  }
  return text;
}

}  // namespace

std::vector<std::string> tokensOf(const std::string& text)
{
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < text.size();)
  {
    const bool word = isWord(text[i]);
    std::size_t end = i + 1;
    while (end < text.size() && isWord(text[end]) == word)
    {
      ++end;
    }
    tokens.push_back(text.substr(i, end - i));
    i = end;
  }
  return tokens;
}

Said saidOf(const Beginning* beginning, const std::vector<Record>& records)
{
  Said said;
  for (const Record& record : records)
  {
    std::vector<std::string> tokens{"record " + std::to_string(static_cast<int>(record.kind)),
                                    record.value ? " true " : " false "};
    const auto statement = tokensOf(record.statement);
    for (const std::string& token : statement)
    {
      if (token.find_first_not_of(' ') != std::string::npos)
      {
        tokens.push_back(token);
      }
    }
    said.push_back(std::move(tokens));
  }
  if (beginning == nullptr)
  {
    return said;
  }
  said.push_back({"begun"});
  for (const Literal& fact : beginning->facts)
  {
    std::vector<std::string> tokens{"fact "};
    append(tokens, fact.atom);
    tokens.emplace_back("=");
    tokens.push_back(fact.value.name);
    said.push_back(std::move(tokens));
  }
  for (const bool exogenous : kExogenous)
  {
    const BeginningLevel& level = beginning->level({exogenous, false});
    const std::string name = exogenous ? "with exogenous " : "without exogenous ";
    if (!level.consistent)
    {
      said.push_back({name, "inconsistent"});
    }
    for (const BeginningComponent& component : level.components)
    {
      for (const BeginningRow& row : component.rows)
      {
        std::vector<std::string> tokens{name + std::to_string(priceOf(row, component)) + ":"};
        for (std::size_t f = 0; f < component.fluents.size(); ++f)
        {
          tokens.emplace_back(" ");
          append(tokens, component.fluents[f].atom);
          tokens.emplace_back("=");
          tokens.push_back(component.fluents[f].values[row.values[f]]);
        }
        said.push_back(std::move(tokens));
      }
    }
  }
  return said;
}

std::string textOf(const Said& said)
{
  std::vector<std::string> lines;
  lines.reserve(said.size());
  for (const auto& tokens : said)
  {
    lines.push_back(joined(tokens));
  }
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const std::string& line : lines)
  {
    text += line + "\n";
  }
  return text;
}

std::vector<std::vector<std::string>> interchangeable(const Description& description)
{
  Description statements = description;
  statements.sorts.clear();
  const std::string text = toString(statements);
  std::set<std::string> named;
  for (const std::string& token : tokensOf(text))
  {
    named.insert(token);
    if (!isWord(token.front()) && token.find_first_of("<>") != std::string::npos)
    {
      return {};
    }
  }
  std::map<std::string, std::vector<bool>> sorts_of;
  std::vector<std::string> order;
  for (std::size_t s = 0; s < description.sorts.size(); ++s)
  {
    named.insert(description.sorts[s].name);
    for (const std::string& element : description.sorts[s].elements)
    {
      auto& in = sorts_of[element];
      if (in.empty())
      {
        in.resize(description.sorts.size());
        order.push_back(element);
      }
      in[s] = true;
    }
  }
  std::map<std::vector<bool>, std::vector<std::string>> classes;
  for (const std::string& element : order)
  {
    const bool number = element.find_first_not_of("-0123456789") == std::string::npos;
    if (!number && named.count(element) == 0)
    {
      classes[sorts_of[element]].push_back(element);
    }
  }
  std::vector<std::vector<std::string>> several;
  for (auto& entry : classes)
  {
    if (entry.second.size() > 1)
    {
      several.push_back(std::move(entry.second));
    }
  }
  return several;
}

Renaming canonicalNames(const Said& said, const std::vector<std::vector<std::string>>& classes)
{
  // What is said of a constant, with `?` for the others that may be renamed.
  std::map<std::string, std::vector<std::string>> of;
  for (const auto& constants : classes)
  {
    for (const std::string& constant : constants)
    {
      of[constant];
    }
  }
  for (const auto& tokens : said)
  {
    std::set<std::string> among;
    for (const std::string& token : tokens)
    {
      if (of.count(token) > 0)
      {
        among.insert(token);
      }
    }
    for (const std::string& constant : among)
    {
      std::string seen;
      for (const std::string& token : tokens)
      {
        seen += token == constant ? "*" : among.count(token) > 0 ? "?" : token;
      }
      of[constant].push_back(std::move(seen));
    }
  }
  for (auto& entry : of)
  {
    std::sort(entry.second.begin(), entry.second.end());
  }
  Renaming renaming;
  for (const auto& constants : classes)
  {
    std::vector<std::string> sorted = constants;
    std::stable_sort(sorted.begin(), sorted.end(), [&](const std::string& a, const std::string& b) {
      return of.at(a) < of.at(b);
    });
    for (std::size_t i = 0; i < sorted.size(); ++i)
    {
      if (sorted[i] != constants[i])
      {
        renaming.set(sorted[i], constants[i]);
      }
    }
  }
  return renaming;
}

namespace
{

Atom renamed(Atom atom, const Renaming& renaming)
{
  for (Term& argument : atom.arguments)
  {
    argument.name = renaming(argument.name);
  }
  return atom;
}

/// The indices that sort some texts.
std::vector<std::size_t> sortedOrder(const std::vector<std::string>& texts)
{
  std::vector<std::size_t> order(texts.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return texts[a] < texts[b]; });
  return order;
}

BeginningComponent renamed(const BeginningComponent& component, const Renaming& renaming)
{
  BeginningComponent result;
  result.assumptions = component.assumptions;
  std::vector<std::string> names;
  for (const OpenFluent& fluent : component.fluents)
  {
    names.push_back(toString(renamed(fluent.atom, renaming)));
  }
  const std::vector<std::size_t> fluents = sortedOrder(names);
  std::vector<std::vector<std::size_t>> places;  // of the old values, by new fluent
  for (const std::size_t f : fluents)
  {
    std::vector<std::string> values;
    for (const std::string& value : component.fluents[f].values)
    {
      values.push_back(renaming(value));
    }
    const std::vector<std::size_t> order = sortedOrder(values);
    OpenFluent fluent{renamed(component.fluents[f].atom, renaming), {}};
    std::vector<std::size_t> place(values.size());
    for (std::size_t i = 0; i < order.size(); ++i)
    {
      place[order[i]] = i;
      fluent.values.push_back(values[order[i]]);
    }
    result.fluents.push_back(std::move(fluent));
    places.push_back(std::move(place));
  }
  for (const BeginningRow& row : component.rows)
  {
    BeginningRow there{{}, row.explanations};
    for (std::size_t i = 0; i < fluents.size(); ++i)
    {
      there.values.push_back(places[i][row.values[fluents[i]]]);
    }
    result.rows.push_back(std::move(there));
  }
  std::sort(result.rows.begin(), result.rows.end(),
            [](const BeginningRow& a, const BeginningRow& b) { return a.values < b.values; });
  return result;
}

int leastPrice(const BeginningComponent& component)
{
  int least = std::numeric_limits<int>::max();
  for (const BeginningRow& row : component.rows)
  {
    least = std::min(least, priceOf(row, component));
  }
  return least;
}

/// With prices in place of what was assumed, of each row above the cheapest one.
BeginningComponent priced(const BeginningComponent& component, const std::string& name)
{
  BeginningComponent result{component.fluents, {}, component.rows};
  const int least = leastPrice(component);
  std::map<int, std::size_t> numbers;
  for (const BeginningRow& row : component.rows)
  {
    numbers.emplace(priceOf(row, component) - least, 0);
  }
  numbers.erase(0);
  for (auto& [price, number] : numbers)
  {
    number = result.assumptions.size();
    result.assumptions.push_back(
        {Clingo::Function("carried", {Clingo::String(name.c_str()), Clingo::Number(price)}), price,
         false});
  }
  for (BeginningRow& row : result.rows)
  {
    const int price = priceOf(row, component) - least;
    row.explanations = {price == 0 ? std::vector<std::size_t>{}
                                   : std::vector<std::size_t>{numbers.at(price)}};
  }
  return result;
}

std::shared_ptr<const BeginningLevel> settledLevel(const BeginningLevel& level)
{
  auto settled = std::make_shared<BeginningLevel>();
  settled->consistent = level.consistent;
  for (const BeginningComponent& component : level.components)
  {
    if (!component.fluents.empty())
    {
      settled->components.push_back(priced(component, toString(component.fluents.front().atom)));
    }
  }
  return settled;
}

std::string nameOf(const BeginningComponent& component)
{
  return toString(component.fluents.front().atom);
}

}  // namespace

std::shared_ptr<const Beginning> renamedBeginning(const std::shared_ptr<const Beginning>& beginning,
                                                  const Renaming& renaming)
{
  if (beginning == nullptr)
  {
    return nullptr;
  }
  auto result = std::make_shared<Beginning>();
  result->first_step = beginning->first_step;
  for (const Literal& fact : beginning->facts)
  {
    Literal there = fact;
    there.atom = renamed(fact.atom, renaming);
    there.value.name = renaming(fact.value.name);
    result->facts.push_back(std::move(there));
  }
  std::sort(result->facts.begin(), result->facts.end(),
            [](const Literal& a, const Literal& b) { return toString(a) < toString(b); });
  for (const bool exogenous : kExogenous)
  {
    const BeginningLevel& level = beginning->level({exogenous, false});
    BeginningLevel there{level.consistent, {}};
    for (const BeginningComponent& component : level.components)
    {
      there.components.push_back(renamed(component, renaming));
    }
    std::sort(there.components.begin(), there.components.end(),
              [](const auto& a, const auto& b) { return nameOf(a) < nameOf(b); });
    // The names of what was assumed follow those of the fluents.
    const auto shared = settledLevel(there);
    result->levels[indexOf({exogenous, false})] = shared;
    result->levels[indexOf({exogenous, true})] = shared;
  }
  return result;
}

bool differsInExceptionsOnly(const BeginningLevel& level)
{
  return level.consistent && std::all_of(level.components.begin(), level.components.end(),
                                         [](const BeginningComponent& component) {
    std::set<int> for_failures;
    for (const BeginningRow& row : component.rows)
    {
      for (const auto& explanation : row.explanations)
      {
        for_failures.insert(std::accumulate(explanation.begin(), explanation.end(), 0,
                                            [&](int sum, std::size_t i) {
          const CarriedAssumption& assumption = component.assumptions[i];
          return sum + (assumption.what.match("fail", 2) ? assumption.price : 0);
        }));
      }
    }
    return for_failures.size() <= 1;
         });
}

std::shared_ptr<const Beginning> settledBeginning(const Beginning& beginning)
{
  auto result = std::make_shared<Beginning>();
  result->first_step = 1;
  result->facts = beginning.facts;
  for (const bool exogenous : kExogenous)
  {
    const auto shared = settledLevel(beginning.level({exogenous, false}));
    result->levels[indexOf({exogenous, false})] = shared;
    result->levels[indexOf({exogenous, true})] = shared;
  }
  return result;
}

}  // namespace kr3::reasoner
