#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdp_format.hpp"

namespace kr3::pomdp
{

namespace
{

std::string exact(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

void checkName(const std::string& name)
{
  static const std::vector<std::string> keywords = {
      "discount", "values",  "states",  "actions",  "observations", "start",   "T",    "O",
      "R",        "uniform", "include", "identity", "reset",        "exclude", "cost", "reward"};
  const bool clean = std::none_of(name.begin(), name.end(), [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) != 0 || c == ':' || c == '#' || c == '*';
  });
  const char first = name.front();
  const bool numeric = std::isdigit(static_cast<unsigned char>(first)) != 0 || first == '-' ||
                       first == '+' || first == '.';
  if (!clean || numeric || std::find(keywords.begin(), keywords.end(), name) != keywords.end())
  {
    throw InvalidArgument("the name '" + name +
                          "' cannot be written to a .pomdp file, expected no blank, ':', '#', '*', "
                          "no digit or sign in front, and no keyword");
  }
}

template <typename NameOf>
void writeNames(std::ostream& out, const char* key, std::size_t count, const NameOf& name_of)
{
  bool numbered = true;
  for (std::size_t i = 0; i < count; ++i)
  {
    numbered = numbered && name_of(i) == std::to_string(i);
  }
  out << key << ':';
  if (numbered)
  {
    out << ' ' << count;
  }
  else
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      checkName(name_of(i));
      out << ' ' << name_of(i);
    }
  }
  out << '\n';
}

}  // namespace

void writePomdp(std::ostream& out, const Model& model)
{
  if (model.initialOutcomes().size() > 1)
  {
    throw InvalidArgument(
        "the robot sees something before its first action, which a .pomdp file cannot say; "
        "expected "
        "a model without, or .pomdpx");
  }
  out << "discount: " << exact(model.discount()) << "\nvalues: reward\n";
  writeNames(out, "states", model.numStates(),
             [&](std::size_t i) -> const std::string& { return model.stateName(i); });
  writeNames(out, "actions", model.numActions(),
             [&](std::size_t i) -> const std::string& { return model.actionName(i); });
  writeNames(out, "observations", model.numObservations(),
             [&](std::size_t i) -> const std::string& { return model.observationName(i); });
  out << "start:";
  for (const double p : model.initialBelief().probabilities())
  {
    out << ' ' << exact(p);
  }
  out << '\n';
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    const std::string& action = model.actionName(a);
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      const std::string& state = model.stateName(s);
      for (const SparseEntry& next : model.transitions(a, s))
      {
        out << "T: " << action << " : " << state << " : " << model.stateName(next.index) << ' '
            << exact(next.probability) << '\n';
      }
      for (const SparseEntry& seen : model.observations(a, s))
      {
        out << "O: " << action << " : " << state << " : " << model.observationName(seen.index)
            << ' ' << exact(seen.probability) << '\n';
      }
      if (model.reward(a, s) != 0.0)
      {
        out << "R: " << action << " : " << state << " : * : * " << exact(model.reward(a, s))
            << '\n';
      }
    }
  }
}

}  // namespace kr3::pomdp
