#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "kr3_pomdp/factored_model.hpp"

namespace kr3::pomdp
{

/// A word of the text in an element, and where it begins in the file.
struct PomdpxWord
{
  std::string text;
  std::ptrdiff_t offset;
};

/// A text in POMDPX, with places in it. Used once.
class PomdpxText
{
public:
  /// @throws InvalidArgument  no well-formed XML
  PomdpxText(std::string text, std::string name);

  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }

  /// @throws InvalidArgument  always: `name:line:column: found ..., expected ...`
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& found,
                         const std::string& expected) const;
  [[noreturn]] void fail(const pugi::xml_node& at, const std::string& found,
                         const std::string& expected) const;
  [[noreturn]] void fail(const PomdpxWord& at, const std::string& expected) const;

  /// The words of an element's own text.
  [[nodiscard]] static std::vector<PomdpxWord> words(const pugi::xml_node& element);
  /// A child that must be there.
  [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const;
  /// An attribute that must be there.
  [[nodiscard]] std::string attribute(const pugi::xml_node& element, const char* name) const;
  [[nodiscard]] double number(const PomdpxWord& word) const;

private:
  std::string text_;
  std::string name_;
  pugi::xml_document document_;
};

/// From elements to a FactoredModel. Used once.
class PomdpxReader
{
public:
  PomdpxReader(std::string text, const std::string& name) : text_(std::move(text), name) {}

  FactoredModel read();

private:
  void variables(const pugi::xml_node& element);
  [[nodiscard]] Variable variable(const pugi::xml_node& element, const char* name_attribute,
                                  const char* prefix) const;
  void declare(const pugi::xml_node& element, const std::string& name, VariableRef ref);
  std::vector<Factor> factors(const pugi::xml_node& section, bool rewards);
  [[nodiscard]] std::vector<VariableRef> references(const pugi::xml_node& element) const;
  void uniformStart();

  PomdpxText text_;
  FactoredModel model_;
  std::map<std::string, VariableRef> names_;
  std::vector<std::string> reward_names_;
};

}  // namespace kr3::pomdp
