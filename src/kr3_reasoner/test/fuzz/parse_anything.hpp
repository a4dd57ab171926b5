#pragma once

#include <cstdlib>
#include <iostream>
#include <string>

#include <kr3_common/error.hpp>

#include "kr3_reasoner/language.hpp"
#include "kr3_reasoner/reasoner.hpp"

namespace kr3::reasoner
{

/// The description that histories and goals are about.
inline const Description& fixedDescription()
{
  static const Description kDescription = parseDescription(
      "sorts\n place = {office, kitchen}.\n robot = {rob1}.\n book = {tb1, tb2}.\n"
      " thing = robot + book.\n level = 0..3.\n"
      "fluents\n inertial loc(thing) : place.\n inertial at(book, place).\n"
      " inertial in_hand(robot, book).\n inertial charge(robot) : level.\n defined free(robot).\n"
      "actions\n move(robot, place).\n grasp(robot, book).\n"
      "axioms\n -at(B, P1) if at(B, P2), P1 != P2.\n"
      " free(R) if -in_hand(R, tb1), -in_hand(R, tb2).\n",
      "fixed");
  return kDescription;
}

/// Ends the program with a message: a fuzzer then keeps the input.
inline void require(bool condition, const std::string& what)
{
  if (!condition)
  {
    std::cerr << what << "\n";
    std::abort();
  }
}

/// Reads a text as a description, a history, a goal and a literal. Each is either refused with
/// InvalidArgument or printed and read again to the same text; anything else ends the program.
inline void parseAnything(const std::string& text)
{
  try
  {
    const std::string printed = toString(parseDescription(text, "input"));
    try
    {
      const std::string again = toString(parseDescription(printed, "printed"));
      require(again == printed,
              "a description changed when it was read again:\n" + printed + "\nbecame\n" + again);
    }
    catch (const InvalidArgument& e)
    {
      require(false,
              "a printed description was refused: " + std::string(e.what()) + "\n" + printed);
    }
  }
  catch (const InvalidArgument&)
  {
  }
  try
  {
    std::string printed;
    for (const Record& record : parseHistory(text, "input", fixedDescription()))
    {
      printed += toString(record) + ".\n";
    }
    static_cast<void>(parseHistory(printed, "printed", fixedDescription()));
  }
  catch (const InvalidArgument&)
  {
  }
  try
  {
    const Formula goal = parseGoal(text, fixedDescription());
    const std::string printed = toString(goal, fixedDescription());
    const std::string again = toString(parseGoal(printed, fixedDescription()), fixedDescription());
    require(again == printed, "the goal " + printed + " became " + again);
  }
  catch (const InvalidArgument&)
  {
  }
}

}  // namespace kr3::reasoner
