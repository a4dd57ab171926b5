#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/finite_horizon.hpp"
#include "kr3_pomdp/policy_bundle.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "kr3_pomdp/pomdp_format.hpp"
#include "kr3_pomdp/pomdpx_format.hpp"
#include "kr3_pomdp/solved_model.hpp"

namespace kr3::pomdp
{

constexpr const char* kInputName = "input";

/// What the readers take here, so that each input is done in moments.
inline ReadOptions smallModels()
{
  ReadOptions options;
  options.max_names = 60;
  options.max_rows = 300;
  options.max_entries = 3000;
  return options;
}

/// @throws std::logic_error  always when `condition` does not hold: a reader or writer is wrong
inline void require(bool condition, const std::string& what)
{
  if (!condition)
  {
    throw std::logic_error(what);
  }
}

/// Calls `read(stream)` on a text, which may throw InvalidArgument with a message that begins with
/// the input's name, or ResourceExhausted.
template <typename Read>
void attempt(const std::string& text, const Read& read)
{
  std::istringstream in(text);
  try
  {
    read(in);
  }
  catch (const InvalidArgument& e)
  {
    require(std::string(e.what()).rfind(kInputName, 0) == 0,
            std::string("a message without its place: ") + e.what());
  }
  catch (const ResourceExhausted&)
  {
  }
}

/// Writes what was read, reads that and writes it again: the same text.
template <typename Write, typename Read>
void requireSameAgain(const std::string& what, const std::string& once, const Write& write,
                      const Read& read)
{
  std::istringstream in(once);
  std::ostringstream again;
  try
  {
    write(again, read(in));
  }
  catch (const Error& e)
  {
    require(false, what + " that was written is refused: " + e.what() + "\n" + once);
  }
  require(again.str() == once, what + " changed:\n" + once + "\nbecame\n" + again.str());
}

inline void readAsPomdp(std::istream& in)
{
  const Model model = readPomdp(in, kInputName, smallModels());
  const auto numbered = [](std::ostream& out, const Model& m) {
    std::stringstream commented;
    writePomdpNumbered(commented, m);
    for (std::string line; std::getline(commented, line);)
    {
      out << (line.rfind('#', 0) == 0 ? "" : line + '\n');  // comments tell the names
    }
  };
  const auto read = [](std::istream& text) { return readPomdp(text, "written"); };
  std::ostringstream numbers;
  numbered(numbers, model);
  requireSameAgain("a .pomdp with numbers", numbers.str(), numbered, read);
  std::ostringstream names;
  try
  {
    writePomdp(names, model);
  }
  catch (const InvalidArgument&)  // names that the format cannot hold
  {
    return;
  }
  requireSameAgain("a .pomdp", names.str(), writePomdp, read);
}

/// The size of the largest sum that flattening computes, or so.
inline double flatWork(const FactoredModel& model)
{
  double work = 1.0;
  for (const StateVariable& variable : model.state)
  {
    const auto size = static_cast<double>(variable.values.size());
    work *= size * size;
  }
  for (const std::vector<Variable>* variables : {&model.actions, &model.observations})
  {
    for (const Variable& variable : *variables)
    {
      work *= static_cast<double>(variable.values.size());
    }
  }
  return work;
}

inline void readAsPomdpx(std::istream& in)
{
  constexpr double kLargestWork = 1e4;
  const FactoredModel model = readPomdpx(in, kInputName, smallModels());
  if (flatWork(model) <= kLargestWork)
  {
    try
    {
      (void)model.flattened(1e-4);
    }
    catch (const InvalidArgument&)  // of the whole: a variable without probabilities, a circle
    {
    }
  }
  const auto write = [](std::ostream& out, const FactoredModel& m) { writePomdpx(out, m); };
  std::ostringstream once;
  try
  {
    write(once, model);
  }
  catch (const InvalidArgument&)  // names that XML can hold and the format cannot
  {
    return;
  }
  requireSameAgain("a .pomdpx", once.str(), write,
                   [](std::istream& text) { return readPomdpx(text, "written"); });
}

inline void readAsPolicy(std::istream& in)
{
  const auto write = [](std::ostream& out, const Policy& policy) { policy.write(out); };
  std::ostringstream once;
  write(once, Policy::read(in, kInputName));
  requireSameAgain("a policy", once.str(), write,
                   [](std::istream& text) { return Policy::read(text, "written"); });
}

inline void readAsHorizonPolicy(std::istream& in)
{
  const auto write = [](std::ostream& out, const HorizonPolicy& policy) { policy.write(out); };
  std::ostringstream once;
  write(once, HorizonPolicy::read(in, kInputName));
  requireSameAgain("a policy over a horizon", once.str(), write,
                   [](std::istream& text) { return HorizonPolicy::read(text, "written"); });
}

/// The model that policies of APPL are read for: two states, or two cells that the robot sees times
/// two states that it does not.
inline Model modelOfPolicies(bool seen)
{
  std::istringstream flat(
      "discount: 0.95\nvalues: reward\nstates: 2\nactions: 3\nobservations: 2\n"
      "T: * identity\nO: * uniform\n");
  std::istringstream cells(
      "<pomdpx><Discount>0.95</Discount><Variable>"
      "<StateVar vnamePrev=\"cell\" vnameCurr=\"cell_1\" fullyObs=\"true\"><NumValues>2</NumValues>"
      "</StateVar><StateVar vnamePrev=\"thing\" vnameCurr=\"thing_1\"><NumValues>2</NumValues>"
      "</StateVar><ActionVar vname=\"action\"><NumValues>3</NumValues></ActionVar>"
      "<RewardVar vname=\"reward\"/></Variable><InitialStateBelief>"
      "<CondProb><Var>cell thing</Var><Parent>null</Parent><Parameter><Entry><Instance>- -"
      "</Instance><ProbTable>uniform</ProbTable></Entry></Parameter></CondProb>"
      "</InitialStateBelief><StateTransitionFunction><CondProb><Var>cell_1 thing_1</Var>"
      "<Parent>null</Parent><Parameter><Entry><Instance>- -</Instance><ProbTable>uniform"
      "</ProbTable></Entry></Parameter></CondProb></StateTransitionFunction><RewardFunction/>"
      "</pomdpx>");
  return seen ? readPomdpx(cells, "cells").flattened() : readPomdp(flat, "flat");
}

inline void readAsApplPolicy(std::istream& in, const Model& model)
{
  const Policy policy = readApplPolicy(in, kInputName, model);
  std::ostringstream once;
  writeApplPolicy(once, policy, model, "model");
  std::istringstream text(once.str());
  try
  {
    (void)readApplPolicy(text, "written", model);
  }
  catch (const Error& e)
  {
    require(false, std::string("a policy of APPL that was written is refused: ") + e.what() + "\n" +
                       once.str());
  }
}

inline void readAsBundle(std::istream& in)
{
  const auto read = [](std::istream& text) {
    return readBundle(text, kInputName, std::size_t{1} << 20U, smallModels());
  };
  std::ostringstream once;
  writeBundle(once, read(in));
  requireSameAgain("a bundle", once.str(), writeBundle, read);
}

/// Reads a text as everything there is: models, policies, a bundle, and what is in a bundle. Each
/// reader refuses it with a message, or what it takes stays the same when it is written and read
/// again.
/// @throws std::logic_error  a reader or writer does otherwise
inline void readAnything(const std::string& text)
{
  static const Model kFlat = modelOfPolicies(false);
  static const Model kSeen = modelOfPolicies(true);
  attempt(text, readAsPomdp);
  attempt(text, readAsPomdpx);
  attempt(text, readAsPolicy);
  attempt(text, readAsHorizonPolicy);
  attempt(text, [](std::istream& in) { readAsApplPolicy(in, kFlat); });
  attempt(text, [](std::istream& in) { readAsApplPolicy(in, kSeen); });
  attempt(text, readAsBundle);
  if (text.rfind("limits ", 0) == 0)  // no input would guess the hash
  {
    attempt("kr3_policy_bundle 1\nhash " + contentHash(text) + '\n' + text, readAsBundle);
  }
}

}  // namespace kr3::pomdp
