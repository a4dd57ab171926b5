#pragma once

#include <set>
#include <string>
#include <vector>

#include "grammar.hpp"
#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// Turns trees into abstract syntax. Knows which names are sorts and which are fluents, since
/// `textbook(X)` may be either. Private to the package.
class Builder
{
public:
  /// @param base  a description whose names may be used, or nullptr
  Builder(std::string file, const Description* base) : file_(std::move(file)), base_(base) {}

  /// Parses all statements of a file. Problems are added, not thrown.
  [[nodiscard]] Description build(const std::string& text);

  [[nodiscard]] Condition condition(const grammar::Node& node);
  [[nodiscard]] Literal literal(const grammar::Node& node);
  [[nodiscard]] static Atom atom(const grammar::Node& node);
  [[nodiscard]] static Term term(const grammar::Node& node);
  [[nodiscard]] Formula formula(const grammar::Node& node);

  std::vector<Diagnostic> problems;

private:
  void declare(const grammar::Node& node, const std::string& section);
  void addAxiom(const grammar::Node& node);
  void addOther(const grammar::Node& node);
  [[nodiscard]] Body body(const grammar::Node& node);
  [[nodiscard]] Effect effect(const grammar::Node& node);
  [[nodiscard]] bool isSort(const std::string& name) const;
  [[nodiscard]] bool isFluent(const std::string& name) const;

  std::string file_;
  const Description* base_;
  Description description_;
};

}  // namespace kr3::reasoner
