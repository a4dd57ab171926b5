#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "grammar.hpp"
#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// `total loc.`: every instance of the predicate fluent has a value.
struct Totality
{
  std::string fluent;
  SourcePosition position;
};

/// Turns trees into abstract syntax. Knows which names are sorts and which are fluents, since
/// `textbook(X)` may be either. Private to the package.
class Builder
{
public:
  /// @param file  the name of what is parsed next, for messages
  /// @param base  a description whose names may be used, or nullptr; must outlive the builder
  Builder(std::string file, const Description* base);

  /// Parses the statements of a file. Several files are one description: what one declares, the
  /// others may use. Problems are added, not thrown.
  /// @param text  must live until `finish`
  void read(std::string_view text, const std::string& file);

  /// The description of all that was read.
  [[nodiscard]] Description finish();

  [[nodiscard]] Literal literal(const grammar::Node& node);
  [[nodiscard]] Atom atom(const grammar::Node& node);
  [[nodiscard]] Formula formula(const grammar::Node& node);
  [[nodiscard]] SourcePosition position(const grammar::Node& node) const;

  std::vector<Diagnostic> problems;
  std::vector<Totality> totalities;

private:
  void declare(const grammar::Node& node, const std::string& section);
  void addStatement(const grammar::Node& node);
  void addExecutability(const grammar::Node& node);
  void addCausalLaw(const grammar::Node& node);
  void addConstraint(const grammar::Node& node);
  [[nodiscard]] Sort sort(const grammar::Node& node);
  [[nodiscard]] Condition condition(const grammar::Node& node);
  [[nodiscard]] Condition withoutSign(const grammar::Node& node);
  [[nodiscard]] Body body(const grammar::Node& node);
  [[nodiscard]] Effect effect(const grammar::Node& node);
  [[nodiscard]] Term term(const grammar::Node& node);
  [[nodiscard]] std::string number(const grammar::Node& node);
  [[nodiscard]] double decimal(const grammar::Node& node);
  [[nodiscard]] bool isSort(const std::string& name) const { return sorts_.count(name) > 0; }
  [[nodiscard]] bool isFluent(const std::string& name) const { return fluents_.count(name) > 0; }
  void report(const grammar::Node& node, const std::string& message);

  /// A statement that needs the names of all declarations, and its file.
  struct Later
  {
    std::string file;
    grammar::Node node;
  };

  std::string file_;
  std::vector<Later> later_;
  const Description* base_;
  Description description_;
  std::unordered_set<std::string> sorts_;
  std::unordered_set<std::string> fluents_;
  std::size_t num_elements_ = 0;  // of all sets and ranges
};

/// The most elements that all sorts of a description may have together.
constexpr std::size_t kMaxElements = 2000000;

/// The name that a node holds directly.
[[nodiscard]] std::string nameOf(const grammar::Node& node);

/// Whether a node is a name, a variable or a number.
[[nodiscard]] bool isTerm(const grammar::Node& node);

}  // namespace kr3::reasoner
