#include "symbol_text.hpp"

namespace kr3::reasoner
{

Clingo::Symbol toSymbol(const std::string& constant)
{
  const bool number =
      constant.find_first_not_of("0123456789", constant[0] == '-' ? 1 : 0) == std::string::npos;
  return number ? Clingo::Number(std::stoi(constant)) : Clingo::Id(constant.c_str());
}

Clingo::Symbol toSymbol(const std::string& name, const std::vector<std::string>& arguments)
{
  Clingo::SymbolVector symbols;
  for (const std::string& argument : arguments)
  {
    symbols.push_back(toSymbol(argument));
  }
  return Clingo::Function(name.c_str(), {symbols.data(), symbols.size()});
}

Clingo::Symbol toSymbol(const Atom& ground)
{
  std::vector<std::string> arguments;
  for (const Term& argument : ground.arguments)
  {
    arguments.push_back(argument.name);
  }
  return toSymbol(ground.name, arguments);
}

}  // namespace kr3::reasoner
