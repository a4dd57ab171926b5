#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "pomdpx_reader.hpp"

namespace kr3::pomdp
{

/// Fills the values of a factor from a `Parameter` element: a table or a decision diagram.
class PomdpxParameter
{
public:
  /// @param names        by the name in the file
  /// @param num_written  entries that were set so far, in all factors
  PomdpxParameter(const XmlText& text, const FactoredModel& model,
                  const std::map<std::string, VariableRef>& names, Factor& factor,
                  std::size_t& num_written);

  void fill(const pugi::xml_node& parameter);

private:
  /// By variable of the factor: its value, or none where any will do.
  using Box = std::vector<std::optional<std::size_t>>;

  void table(const pugi::xml_node& parameter);
  void entry(const pugi::xml_node& element);
  void diagram(const pugi::xml_node& parameter);
  void branch(const pugi::xml_node& parent, Box& box, int depth);
  void node(const pugi::xml_node& element, Box& box, int depth);
  void shorthand(const pugi::xml_node& element, Box& box, int depth);
  void persist(const pugi::xml_node& element, std::size_t place, const Box& box);

  /// Sets all entries in the box to what `value` says of their values.
  /// @param at  the element that says so, for messages
  template <typename Value>
  void set(const pugi::xml_node& at, const Box& box, const Value& value);

  [[nodiscard]] const Variable& variable(std::size_t place) const
  {
    return model_.variable(scope_[place]);
  }
  [[nodiscard]] std::size_t valueOf(const XmlWord& word, std::size_t place) const;
  /// Place in the scope of the variable that an attribute names.
  [[nodiscard]] std::size_t placeOf(const pugi::xml_node& element) const;

  const XmlText& text_;
  const FactoredModel& model_;
  const std::map<std::string, VariableRef>& names_;
  Factor& factor_;
  std::size_t& num_written_;
  std::vector<VariableRef> scope_;    // parents, then what the factor is of
  std::vector<std::size_t> sizes_;    // of the variables in the scope
  std::vector<std::size_t> strides_;  // in the factor
  std::size_t num_outcomes_ = 1;
  std::map<std::string, pugi::xml_node> templates_;
  // By variable of the scope: its values' indices, made when they are first asked for.
  mutable std::vector<std::unordered_map<std::string_view, std::size_t>> value_indices_;
};

}  // namespace kr3::pomdp
