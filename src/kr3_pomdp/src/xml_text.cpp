#include "xml_text.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>

#include "file_text.hpp"
#include "number_text.hpp"

namespace kr3::pomdp
{

namespace
{

// Ends of lines stay as they are, so that offsets within a text are those in the file.
constexpr unsigned kParseFlags = pugi::parse_default & ~pugi::parse_eol;

bool isBlank(char c)
{
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

}  // namespace

XmlText::XmlText(std::string text, std::string name)
  : text_(std::move(text)), name_(std::move(name))
{
  const pugi::xml_parse_result result =
      document_.load_buffer(text_.data(), text_.size(), kParseFlags, pugi::encoding_utf8);
  if (!result)
  {
    fail(result.offset, result.description(), "well-formed XML");
  }
}

void XmlText::fail(std::ptrdiff_t offset, const std::string& found,
                   const std::string& expected) const
{
  const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0));
  throw InvalidArgument(placeIn(text_, from, name_) + "found " + found + ", expected " + expected);
}

void XmlText::fail(const pugi::xml_node& at, const std::string& found,
                   const std::string& expected) const
{
  throw InvalidArgument(place(at) + "found " + found + ", expected " + expected);
}

void XmlText::fail(const XmlWord& at, const std::string& expected) const
{
  fail(at.offset, "'" + std::string(at.text) + "'", expected);
}

std::string XmlText::place(const pugi::xml_node& element) const
{
  const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(element.offset_debug(), 1));
  return placeIn(text_, offset - 1, name_);  // from the name to its bracket
}

void XmlText::failTooLarge(const pugi::xml_node& at, const std::string& what) const
{
  throw ResourceExhausted(place(at) + what);
}

std::vector<XmlWord> XmlText::words(const pugi::xml_node& element)
{
  std::vector<XmlWord> words;
  for (const pugi::xml_node& child : element.children())
  {
    if (child.type() != pugi::node_pcdata && child.type() != pugi::node_cdata)
    {
      continue;
    }
    const char* const begin = child.value();
    const std::ptrdiff_t offset = child.offset_debug();
    for (const char* at = begin; *at != '\0';)
    {
      const char* const first = at;
      while (*at != '\0' && !isBlank(*at))
      {
        ++at;
      }
      if (first != at)
      {
        words.push_back({{first, static_cast<std::size_t>(at - first)}, offset + (first - begin)});
      }
      while (isBlank(*at))
      {
        ++at;
      }
    }
  }
  return words;
}

pugi::xml_node XmlText::child(const pugi::xml_node& parent, const char* name) const
{
  const pugi::xml_node found = parent.child(name);
  if (!found)
  {
    fail(parent, std::string("<") + parent.name() + "> without it",
         std::string("a <") + name + "> inside");
  }
  return found;
}

std::string XmlText::attribute(const pugi::xml_node& element, const char* name) const
{
  const std::string value = element.attribute(name).value();
  if (value.empty())
  {
    fail(element, std::string("<") + element.name() + "> without it",
         std::string("an attribute '") + name + "'");
  }
  return value;
}

std::size_t XmlText::index(const pugi::xml_node& element, const char* name, std::size_t limit,
                           const std::string& what) const
{
  const std::string text = attribute(element, name);
  const auto value = indexNumber(text);
  if (!value || *value >= limit)
  {
    fail(element, std::string(name) + " '" + text + "'",
         "the index of one of " + std::to_string(limit) + " " + what);
  }
  return *value;
}

double XmlText::number(const XmlWord& word) const
{
  const auto value = finiteNumber(word.text);
  if (!value)
  {
    fail(word, "a number");
  }
  return *value;
}

std::string xmlEscaped(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    switch (c)
    {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

}  // namespace kr3::pomdp
