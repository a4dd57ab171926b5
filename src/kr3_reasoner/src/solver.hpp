#pragma once

#include <memory>
#include <string>
#include <vector>

#include <clingo.hh>

namespace kr3::reasoner
{

/// A clingo control whose messages end up in our errors. Private to the package; not thread-safe.
class Solver
{
public:
  explicit Solver(const std::vector<std::string>& arguments);

  [[nodiscard]] Clingo::Control& control() { return *control_; }

  void add(const std::string& part, const std::vector<std::string>& parameters,
           const std::string& program);

  /// A part of the program, with a number for its parameter if it has one.
  struct Part
  {
    std::string name;
    std::vector<int> parameters;
  };

  /// Grounds parts together: what one defines, the others may define too.
  void ground(const std::vector<Part>& parts);

  /// Sets an option of the solver, as `solve.models`.
  void configure(const std::string& key, const std::string& value);

private:
  std::unique_ptr<std::string> messages_;  // the logger keeps its address
  std::unique_ptr<Clingo::Control> control_;
};

/// A symbol in the language: `loc(rob1)`, with a space after each comma.
[[nodiscard]] std::string toText(Clingo::Symbol symbol);

}  // namespace kr3::reasoner
