#include "literal_text.hpp"

#include <algorithm>
#include <cctype>

namespace kr3::executive
{
namespace
{

std::string trimmed(const std::string& text)
{
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos)
    return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace

std::string LiteralText::fluent() const
{
  std::string text = symbol;
  for (std::size_t i = 0; i < arguments.size(); ++i)
    text += (i == 0 ? "(" : ", ") + arguments[i];
  return arguments.empty() ? text : text + ")";
}

LiteralText takeApart(const std::string& text)
{
  LiteralText literal;
  literal.value = "true";
  std::string atom = trimmed(text);
  if (const auto equals = atom.find('='); equals != std::string::npos)
  {
    literal.equal = equals == 0 || atom[equals - 1] != '!';
    literal.value = trimmed(atom.substr(equals + 1));
    atom = trimmed(atom.substr(0, literal.equal ? equals : equals - 1));
  }
  if (!atom.empty() && atom.front() == '-')
  {
    literal.value = "false";
    atom = trimmed(atom.substr(1));
  }
  const auto open = atom.find('(');
  literal.symbol = atom.substr(0, open);
  if (open == std::string::npos)
    return literal;
  const auto close = atom.rfind(')');
  std::string rest = atom.substr(open + 1, close == std::string::npos ? close : close - open - 1);
  for (std::size_t begin = 0; begin <= rest.size();)
  {
    const auto comma = std::min(rest.find(',', begin), rest.size());
    literal.arguments.push_back(trimmed(rest.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  return literal;
}

bool isVariable(const std::string& term)
{
  return !term.empty() && std::isupper(static_cast<unsigned char>(term.front())) != 0;
}

std::string listed(const std::vector<std::string>& items)
{
  if (items.empty())
    return "nothing";
  std::string text = items.front();
  for (std::size_t i = 1; i < items.size(); ++i)
    text += (i + 1 == items.size() ? " and " : ", ") + items[i];
  return text;
}

}  // namespace kr3::executive
