#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

namespace kr3::pomdp
{

/// A word of the text in an element, and where it begins in the file. Valid as long as the XmlText.
struct XmlWord
{
  std::string_view text;
  std::ptrdiff_t offset;
};

/// An XML text, with places in it.
class XmlText
{
public:
  /// @throws InvalidArgument  no well-formed XML
  XmlText(std::string text, std::string name);

  [[nodiscard]] pugi::xml_node root() const { return document_.document_element(); }

  /// @throws InvalidArgument  always: `name:line:column: found ..., expected ...`
  [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& found,
                         const std::string& expected) const;
  [[noreturn]] void fail(const pugi::xml_node& at, const std::string& found,
                         const std::string& expected) const;
  [[noreturn]] void fail(const XmlWord& at, const std::string& expected) const;

  /// @throws ResourceExhausted  always: `name:line:column: what`
  [[noreturn]] void failTooLarge(const pugi::xml_node& at, const std::string& what) const;

  /// `name:line:column: ` of an element.
  [[nodiscard]] std::string place(const pugi::xml_node& element) const;

  /// The words of an element's own text.
  [[nodiscard]] static std::vector<XmlWord> words(const pugi::xml_node& element);
  /// A child that must be there.
  [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const;
  /// An attribute that must be there.
  [[nodiscard]] std::string attribute(const pugi::xml_node& element, const char* name) const;
  /// An attribute that must be an index below `limit`.
  /// @param what  is counted, for messages
  [[nodiscard]] std::size_t index(const pugi::xml_node& element, const char* name,
                                  std::size_t limit, const std::string& what) const;
  [[nodiscard]] double number(const XmlWord& word) const;

private:
  std::string text_;
  std::string name_;
  pugi::xml_document document_;
};

/// A text as it stands in XML, between tags or in double quotes.
[[nodiscard]] std::string xmlEscaped(const std::string& text);

}  // namespace kr3::pomdp
