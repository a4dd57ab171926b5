#include <algorithm>
#include <cctype>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdp_format.hpp"
#include "number_text.hpp"

namespace kr3::pomdp
{

namespace
{

bool isKeyword(const std::string& name)
{
  static const std::vector<std::string> keywords = {
      "discount", "values",  "states",  "actions",  "observations", "start",   "T",    "O",
      "R",        "uniform", "include", "identity", "reset",        "exclude", "cost", "reward"};
  return std::find(keywords.begin(), keywords.end(), name) != keywords.end();
}

/// Whether our reader takes it back as it is.
bool fitsOurs(const std::string& name)
{
  const bool clean = std::none_of(name.begin(), name.end(), [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) != 0 || c == ':' || c == '#' || c == '*';
  });
  const char first = name.front();
  const bool numeric = std::isdigit(static_cast<unsigned char>(first)) != 0 || first == '-' ||
                       first == '+' || first == '.';
  return clean && !numeric && !isKeyword(name);
}

/// Whether all tools do.
bool fitsAll(const std::string& name)
{
  return fitsOurs(name) && std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
         });
}

/// The names of one kind of thing as they stand in the file.
struct Names
{
  std::string kind;
  std::vector<std::string> original;
  std::vector<std::string> written;
  bool numbered = false;
};

template <typename NameOf>
Names namesOf(const char* kind, std::size_t count, const NameOf& name_of, bool may_number)
{
  Names names;
  names.kind = kind;
  names.numbered = true;
  std::optional<std::size_t> unfit;
  for (std::size_t i = 0; i < count; ++i)
  {
    names.original.push_back(name_of(i));
    const std::string& name = names.original.back();
    names.numbered = names.numbered && name == std::to_string(i);
    if (!unfit && !(may_number ? fitsAll(name) : fitsOurs(name)))
    {
      unfit = i;
    }
  }
  if (unfit && !names.numbered && !may_number)
  {
    throw InvalidArgument("the name '" + names.original[*unfit] +
                          "' cannot be written to a .pomdp file, expected no blank, ':', '#', "
                          "'*', no digit or sign in front, and no keyword");
  }
  names.numbered = names.numbered || unfit;
  names.written = names.original;
  for (std::size_t i = 0; names.numbered && i < count; ++i)
  {
    names.written[i] = std::to_string(i);
  }
  return names;
}

/// The line that declares names, and comments that tell those that have numbers.
void declare(std::ostream& out, const Names& names)
{
  out << names.kind << "s:";
  if (!names.numbered)
  {
    for (const std::string& name : names.written)
    {
      out << ' ' << name;
    }
    out << '\n';
    return;
  }
  out << ' ' << names.written.size() << '\n';
  for (std::size_t i = 0; names.original != names.written && i < names.original.size(); ++i)
  {
    std::string name = names.original[i];
    std::replace(name.begin(), name.end(), '\n', ' ');
    out << "# " << names.kind << ' ' << i << ": " << name << '\n';
  }
}

std::vector<std::string> write(std::ostream& out, const Model& model, bool may_number)
{
  if (model.initialOutcomes().size() > 1)
  {
    throw InvalidArgument(
        "the robot sees something before its first action, which a .pomdp file cannot say; "
        "expected a model without, or .pomdpx");
  }
  const Names states = namesOf(
      "state", model.numStates(), [&](std::size_t i) { return model.stateName(i); }, may_number);
  const Names actions = namesOf(
      "action", model.numActions(), [&](std::size_t i) { return model.actionName(i); }, may_number);
  const Names observations = namesOf(
      "observation", model.numObservations(),
      [&](std::size_t i) { return model.observationName(i); }, may_number);
  out << "discount: " << exactText(model.discount()) << "\nvalues: reward\n";
  declare(out, states);
  declare(out, actions);
  declare(out, observations);
  out << "start:";
  for (const double p : model.initialBelief().probabilities())
  {
    out << ' ' << exactText(p);
  }
  out << '\n';
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    for (std::size_t s = 0; s < model.numStates(); ++s)
    {
      const std::string place = ": " + actions.written[a] + " : " + states.written[s] + " : ";
      for (const SparseEntry& next : model.transitions(a, s))
      {
        out << 'T' << place << states.written[next.index] << ' ' << exactText(next.probability)
            << '\n';
      }
      for (const SparseEntry& seen : model.observations(a, s))
      {
        out << 'O' << place << observations.written[seen.index] << ' '
            << exactText(seen.probability) << '\n';
      }
      if (model.reward(a, s) != 0.0)
      {
        out << 'R' << place << "* : * " << exactText(model.reward(a, s)) << '\n';
      }
    }
  }
  std::vector<std::string> numbered;
  for (const Names* names : {&states, &actions, &observations})
  {
    if (names->original != names->written)
    {
      numbered.push_back(names->kind);
    }
  }
  return numbered;
}

}  // namespace

void writePomdp(std::ostream& out, const Model& model)
{
  write(out, model, false);
}

std::vector<std::string> writePomdpNumbered(std::ostream& out, const Model& model)
{
  return write(out, model, true);
}

}  // namespace kr3::pomdp
