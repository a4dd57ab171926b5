#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <clingo.hh>

#include "search_limit.hpp"
#include "solve_watch.hpp"

namespace kr3::reasoner
{

/// A clingo control whose messages end up in our errors, and whose work ends with a limit. Private
/// to the package; not thread-safe.
class Solver
{
public:
  /// @param limit  of all that the solver does, until limitTo() gives another one
  explicit Solver(std::vector<std::string> arguments, const SearchLimit& limit = {});

  ~Solver();
  Solver(Solver&&) = delete;
  Solver& operator=(Solver&&) = delete;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  void limitTo(const SearchLimit& limit);

  /// Made when it is first asked for: what turns out to be constant needs none.
  [[nodiscard]] Clingo::Control& control();

  void add(const std::string& part, const std::vector<std::string>& parameters,
           const std::string& program);

  /// A part of the program, with a number for its parameter if it has one.
  struct Part
  {
    std::string name;
    std::vector<int> parameters;
  };

  /// Grounds parts together: what one defines, the others may define too.
  /// @throws Cancelled, DeadlineExceeded  the limit was reached; the solver is then worth nothing
  void ground(const std::vector<Part>& parts);

  /// Shows `visit` the answer sets that agree with some literals, until it returns false. A model
  /// is valid during the call only.
  /// @return whether there is one
  /// @throws Cancelled, DeadlineExceeded  the limit was reached
  bool solve(const std::function<bool(const Clingo::Model&)>& visit,
             const std::vector<Clingo::literal_t>& assumed = {});
  [[nodiscard]] bool isSatisfiable(const std::vector<Clingo::literal_t>& assumed = {});

  /// Sets an option of the solver, as `solve.models`.
  void configure(const std::string& key, const std::string& value);

private:
  class GroundingLimit;

  [[noreturn]] void failAfterInterrupt() const;

  std::vector<std::string> arguments_;
  std::unique_ptr<std::string> messages_;  // the logger keeps its address
  SearchLimit limit_;
  std::unique_ptr<GroundingLimit> grounding_limit_;  // the control keeps its address
  std::unique_ptr<Clingo::Control> control_;
  std::unique_ptr<SolveWatch> watch_;  // the last: it uses the control
};

/// A symbol in the language: `loc(rob1)`, with a space after each comma.
[[nodiscard]] std::string toText(Clingo::Symbol symbol);

}  // namespace kr3::reasoner
