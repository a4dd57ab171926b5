#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include "kr3_pomdp/factored_model.hpp"
#include "kr3_pomdp/read_options.hpp"
#include "xml_text.hpp"

namespace kr3::pomdp
{

/// From elements to a FactoredModel. Used once.
class PomdpxReader
{
public:
  PomdpxReader(std::string text, const std::string& name, ReadOptions options = {})
    : text_(std::move(text), name), options_(std::move(options))
  {
  }

  FactoredModel read();

private:
  void variables(const pugi::xml_node& element);
  [[nodiscard]] Variable variable(const pugi::xml_node& element, const char* name_attribute,
                                  const char* prefix) const;
  void declare(const pugi::xml_node& element, const std::string& name, VariableRef ref);
  std::vector<Factor> factors(const pugi::xml_node& section, bool rewards);
  [[nodiscard]] std::vector<VariableRef> references(const pugi::xml_node& element) const;
  /// @throws ResourceExhausted  the options allow a variable fewer values
  void checkCount(const pugi::xml_node& element, std::size_t num_values) const;
  /// Zeros of the right number.
  void allocate(Factor& factor, const pugi::xml_node& element);
  void checkSums(const Factor& factor, const pugi::xml_node& element) const;
  void uniformStart();

  XmlText text_;
  ReadOptions options_;
  FactoredModel model_;
  std::map<std::string, VariableRef> names_;
  std::vector<std::string> reward_names_;
  std::size_t num_entries_ = 0;  // of all tables
  std::size_t num_written_ = 0;  // into them
};

}  // namespace kr3::pomdp
