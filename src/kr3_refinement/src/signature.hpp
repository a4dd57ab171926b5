#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include <kr3_reasoner/language.hpp>

#include "rule.hpp"

namespace kr3::refinement
{

/// The constant that each ground fluent has in a state, by index of the ground fluent; kNone where
/// it has none (yet).
using Values = std::vector<int>;

/// A ground fluent of a description, restricted to the zoom.
struct PhysicalFluent
{
  std::string name;
  std::size_t symbol = 0;
  std::vector<int> arguments;
  std::vector<int> values;
  bool defined = false;
};

/// Whether two values are the same, where one may be `elsewhere`.
enum class Equality
{
  kEqual,
  kDifferent,
  kUndetermined,
};

/// Which bodies match where a fluent is `elsewhere`, at some value outside the zoom that the state
/// does not tell: those that hold whatever the value is, or those that hold for some value.
enum class Truth
{
  kSurely,
  kPossibly,
};

/// A fluent or static with the numbers to find its ground instances.
struct Symbol
{
  std::string name;
  bool is_static = false;
  bool defined = false;
  bool boolean = true;
  std::vector<const ConstantSet*> full_argument_sorts;
  std::vector<const ConstantSet*> argument_sorts;
  const ConstantSet* full_value_sort = nullptr;
  const ConstantSet* value_sort = nullptr;
  std::vector<std::vector<int>>
      positions;           ///< [argument][constant] -> position in its sort, kNone outside
  std::size_t offset = 0;  ///< of the first ground instance
  std::size_t size = 0;    ///< number of ground instances
};

/// Sorts, statics and physical fluents of a description, with those constants that the zoom keeps.
/// Statics are kept whole. Knowledge fluents, and what is defined by them, are left out:
/// `isLeftOut`.
class Signature
{
public:
  /// @param constants       what the zoom keeps; nullptr: everything
  /// @param with_elsewhere  ground fluents that get one more value, named `elsewhere`
  Signature(const reasoner::Description& description, const std::set<std::string>* constants,
            const std::set<std::string>& with_elsewhere, const std::string& elsewhere);
  Signature(const Signature&) = delete;
  Signature& operator=(const Signature&) = delete;
  ~Signature() = default;

  [[nodiscard]] const Vocabulary& vocabulary() const { return vocabulary_; }
  [[nodiscard]] int trueValue() const { return true_; }
  [[nodiscard]] int falseValue() const { return false_; }
  [[nodiscard]] bool isElsewhere(int value) const
  {
    return value == elsewhere_ && value != Vocabulary::kNone;
  }
  [[nodiscard]] int elsewhere() const { return elsewhere_; }

  [[nodiscard]] const ConstantSet& sort(const std::string& name) const { return sorts_.at(name); }
  [[nodiscard]] const ConstantSet& fullSort(const std::string& name) const
  {
    return full_sorts_.at(name);
  }

  [[nodiscard]] const std::vector<Symbol>& symbols() const { return symbols_; }
  [[nodiscard]] std::optional<std::size_t> findSymbol(const std::string& name) const;
  [[nodiscard]] bool isLeftOut(const std::string& fluent) const
  {
    return left_out_.count(fluent) > 0;
  }

  /// Inertial fluents first, then defined ones.
  [[nodiscard]] const std::vector<PhysicalFluent>& fluents() const { return fluents_; }
  [[nodiscard]] std::size_t numInertial() const { return num_inertial_; }
  [[nodiscard]] std::optional<std::size_t> findFluent(const std::string& name) const;

  /// Index of a ground fluent; nothing when it is outside the zoom or a static.
  [[nodiscard]] std::optional<std::size_t> fluentIndex(const CompiledLiteral& literal,
                                                       const Binding& binding) const;

  /// The value of a ground fluent or static; kNone when unknown or outside.
  [[nodiscard]] int value(const CompiledLiteral& literal, const Binding& binding,
                          const Values& state) const;

  /// Whether two values of a fluent or static are the same. `elsewhere` is one of the values
  /// outside the zoom; of a boolean one it is either.
  [[nodiscard]] Equality equality(int left, int right, const Symbol& symbol) const
  {
    return equality(left, right, *symbol.value_sort, *symbol.full_value_sort);
  }
  /// @param kept  the values inside the zoom
  /// @param full  all values
  [[nodiscard]] Equality equality(int left, int right, const ConstantSet& kept,
                                  const ConstantSet& full) const;

  void setStatic(const CompiledLiteral& literal, const Binding& binding, int value);

  [[nodiscard]] static int constantOf(const Slot& slot, const Binding& binding)
  {
    return slot.is_variable ? binding[static_cast<std::size_t>(slot.id)] : slot.id;
  }

private:
  void addSorts(const reasoner::Description& description, const std::set<std::string>* constants);
  void findLeftOut(const reasoner::Description& description);
  void addSymbol(const reasoner::FluentDeclaration& declaration);
  void addFluents(std::size_t symbol, const std::set<std::string>& with_elsewhere);
  [[nodiscard]] std::optional<std::size_t> instance(const Symbol& symbol,
                                                    const std::vector<Slot>& arguments,
                                                    const Binding& binding) const;

  Vocabulary vocabulary_;
  int true_ = 0;
  int false_ = 0;
  int elsewhere_ = Vocabulary::kNone;
  ConstantSet truth_values_;
  std::unordered_map<std::string, ConstantSet> full_sorts_;
  std::unordered_map<std::string, ConstantSet> sorts_;
  std::set<std::string> left_out_;
  std::vector<Symbol> symbols_;
  std::unordered_map<std::string, std::size_t> symbol_index_;
  std::vector<PhysicalFluent> fluents_;
  std::unordered_map<std::string, std::size_t> fluent_index_;
  std::size_t num_inertial_ = 0;
  std::vector<int> static_values_;
};

}  // namespace kr3::refinement
