#include "solver.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::reasoner
{

/// Sees each ground rule as it is made, which is the only place where grounding can be ended.
class Solver::GroundingLimit : public Clingo::GroundProgramObserver
{
public:
  explicit GroundingLimit(const SearchLimit& limit) : limit_(limit) {}

  void rule(bool /*choice*/, Clingo::AtomSpan /*head*/, Clingo::LiteralSpan /*body*/) override
  {
    limit_.check();
  }

private:
  const SearchLimit& limit_;
};

Solver::Solver(std::vector<std::string> arguments, const SearchLimit& limit)
  : arguments_(std::move(arguments)), messages_(std::make_unique<std::string>()), limit_(limit)
{
}

Solver::~Solver() = default;

Clingo::Control& Solver::control()
{
  if (!control_)
  {
    constexpr unsigned kMostMessages = 20;
    std::vector<const char*> pointers;
    for (const std::string& argument : arguments_)
    {
      pointers.push_back(argument.c_str());
    }
    control_ = std::make_unique<Clingo::Control>(
        Clingo::StringSpan(pointers.data(), pointers.size()),
        [messages = messages_.get()](Clingo::WarningCode, const char* message) {
      messages->append(message).append("\n");
        },
        kMostMessages);
    limitTo(limit_);
  }
  return *control_;
}

void Solver::limitTo(const SearchLimit& limit)
{
  watch_.reset();
  limit_ = limit;
  if (limit_.isSet() && control_)
  {
    watch_ = std::make_unique<SolveWatch>(*control_, limit_);
  }
}

void Solver::add(const std::string& part, const std::vector<std::string>& parameters,
                 const std::string& program)
{
  std::vector<const char*> names;
  for (const std::string& parameter : parameters)
  {
    names.push_back(parameter.c_str());
  }
  try
  {
    control().add(part.c_str(), Clingo::StringSpan(names.data(), names.size()), program.c_str());
  }
  catch (const std::exception& e)
  {
    throw InternalError("the generated program is malformed: " + std::string(e.what()) + "\n" +
                        *messages_);
  }
}

void Solver::ground(const std::vector<Part>& parts)
{
  std::vector<Clingo::SymbolVector> symbols;
  for (const Part& part : parts)
  {
    symbols.emplace_back();
    for (const int parameter : part.parameters)
    {
      symbols.back().push_back(Clingo::Number(parameter));
    }
  }
  std::vector<Clingo::Part> ground_parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    ground_parts.emplace_back(parts[i].name.c_str(),
                              Clingo::SymbolSpan(symbols[i].data(), symbols[i].size()));
  }
  if (limit_.isSet() && !grounding_limit_)
  {
    grounding_limit_ = std::make_unique<GroundingLimit>(limit_);
    control().register_observer(*grounding_limit_);
  }
  try
  {
    control().ground(Clingo::PartSpan(ground_parts.data(), ground_parts.size()));
  }
  catch (const std::exception& e)
  {
    limit_.check();
    throw InternalError("grounding failed: " + std::string(e.what()) + "\n" + *messages_);
  }
}

bool Solver::solve(const std::function<bool(const Clingo::Model&)>& visit,
                   const std::vector<Clingo::literal_t>& assumed)
{
  limit_.check();
  bool found = false;
  auto handle =
      control().solve(Clingo::LiteralSpan(assumed.data(), assumed.size()), nullptr, false, true);
  for (const Clingo::Model& model : handle)
  {
    found = true;
    if (!visit(model))
    {
      return true;
    }
  }
  if (handle.get().is_interrupted())
  {
    failAfterInterrupt();
  }
  return found;
}

bool Solver::isSatisfiable(const std::vector<Clingo::literal_t>& assumed)
{
  limit_.check();
  const Clingo::SolveResult result =
      control()
          .solve(Clingo::LiteralSpan(assumed.data(), assumed.size()), nullptr, false, false)
          .get();
  if (!result.is_satisfiable() && result.is_interrupted())
  {
    failAfterInterrupt();
  }
  return result.is_satisfiable();
}

void Solver::failAfterInterrupt() const
{
  limit_.check();
  throw Cancelled(std::string(limit_.question) + " was interrupted");
}

void Solver::configure(const std::string& key, const std::string& value)
{
  Clingo::Configuration node = control().configuration();
  std::size_t start = 0;
  while (start <= key.size())
  {
    const std::size_t dot = std::min(key.find('.', start), key.size());
    node = node[key.substr(start, dot - start).c_str()];
    start = dot + 1;
  }
  node = value.c_str();
}

std::string toText(Clingo::Symbol symbol)
{
  if (symbol.type() != Clingo::SymbolType::Function || symbol.arguments().empty())
  {
    return symbol.to_string();
  }
  std::string text = symbol.name();
  const char* separator = "(";
  for (const Clingo::Symbol& argument : symbol.arguments())
  {
    text += separator + toText(argument);
    separator = ", ";
  }
  return text + ")";
}

}  // namespace kr3::reasoner
