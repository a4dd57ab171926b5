#include "signature.hpp"

#include <variant>

namespace kr3::refinement
{
namespace
{

using reasoner::FluentKind;

/// The next choice of one element of each list, as an odometer; false after the last.
bool advance(std::vector<std::size_t>& digits, const std::vector<const ConstantSet*>& sorts)
{
  for (std::size_t i = digits.size(); i-- > 0;)
  {
    if (++digits[i] < sorts[i]->elements().size())
    {
      return true;
    }
    digits[i] = 0;
  }
  return false;
}

bool mentions(const reasoner::Body& body, const std::set<std::string>& names)
{
  for (const reasoner::Condition& condition : body)
  {
    const auto* literal = std::get_if<reasoner::Literal>(&condition);
    if (literal != nullptr && names.count(literal->atom.name) > 0)
    {
      return true;
    }
  }
  return false;
}

}  // namespace

Signature::Signature(const reasoner::Description& description,
                     const std::set<std::string>* constants,
                     const std::set<std::string>& with_elsewhere, const std::string& elsewhere)
{
  true_ = vocabulary_.intern("true");
  false_ = vocabulary_.intern("false");
  truth_values_ = ConstantSet({false_, true_});
  addSorts(description, constants);
  if (!elsewhere.empty())
  {
    elsewhere_ = vocabulary_.intern(elsewhere);
  }
  findLeftOut(description);
  for (const reasoner::FluentDeclaration& declaration : description.fluents)
  {
    addSymbol(declaration);
  }
  for (const bool defined : {false, true})
  {
    for (std::size_t symbol = 0; symbol < symbols_.size(); ++symbol)
    {
      if (!symbols_[symbol].is_static && symbols_[symbol].defined == defined)
      {
        addFluents(symbol, with_elsewhere);
      }
    }
    num_inertial_ = defined ? num_inertial_ : fluents_.size();
  }
}

void Signature::addSorts(const reasoner::Description& description,
                         const std::set<std::string>* constants)
{
  for (const reasoner::Sort& sort : description.sorts)
  {
    std::vector<int> full;
    std::vector<int> kept;
    for (const std::string& element : sort.elements)
    {
      const int constant = vocabulary_.intern(element);
      full.push_back(constant);
      if (constants == nullptr || constants->count(element) > 0)
      {
        kept.push_back(constant);
      }
    }
    full_sorts_.emplace(sort.name, ConstantSet(std::move(full)));
    sorts_.emplace(sort.name, ConstantSet(std::move(kept)));
  }
}

void Signature::findLeftOut(const reasoner::Description& description)
{
  for (const reasoner::FluentDeclaration& declaration : description.fluents)
  {
    if (declaration.kind == FluentKind::kKnowledge)
    {
      left_out_.insert(declaration.name);
    }
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const reasoner::StateConstraint& constraint : description.constraints)
    {
      if (constraint.head && mentions(constraint.body, left_out_))
      {
        const reasoner::FluentDeclaration* head =
            description.findFluent(constraint.head->atom.name);
        changed = (head != nullptr && head->kind == FluentKind::kDefined &&
                   left_out_.insert(head->name).second) ||
                  changed;
      }
    }
  }
}

void Signature::addSymbol(const reasoner::FluentDeclaration& declaration)
{
  if (left_out_.count(declaration.name) > 0)
  {
    return;
  }
  Symbol symbol;
  symbol.name = declaration.name;
  symbol.is_static = declaration.kind == FluentKind::kStatic;
  symbol.defined = declaration.kind == FluentKind::kDefined;
  symbol.boolean = !declaration.value_sort.has_value();
  symbol.full_value_sort =
      symbol.boolean ? &truth_values_ : &full_sorts_.at(*declaration.value_sort);
  symbol.value_sort = symbol.boolean ? &truth_values_ : &sorts_.at(*declaration.value_sort);
  symbol.size = 1;
  for (const std::string& sort : declaration.argument_sorts)
  {
    symbol.full_argument_sorts.push_back(&full_sorts_.at(sort));
    symbol.argument_sorts.push_back(&sorts_.at(sort));
    const ConstantSet& elements =
        symbol.is_static ? *symbol.full_argument_sorts.back() : *symbol.argument_sorts.back();
    std::vector<int> positions(vocabulary_.size(), Vocabulary::kNone);
    for (std::size_t i = 0; i < elements.elements().size(); ++i)
    {
      positions[static_cast<std::size_t>(elements.elements()[i])] = static_cast<int>(i);
    }
    symbol.positions.push_back(std::move(positions));
    symbol.size *= elements.elements().size();
  }
  if (!symbol.is_static && symbol.value_sort->elements().empty())
  {
    symbol.size = 0;  // its values are all outside the zoom: it vanishes, or keeps only `elsewhere`
  }
  if (symbol.is_static)
  {
    symbol.offset = static_values_.size();
    static_values_.resize(static_values_.size() + symbol.size,
                          symbol.boolean ? false_ : Vocabulary::kNone);
  }
  symbol_index_.emplace(symbol.name, symbols_.size());
  symbols_.push_back(std::move(symbol));
}

void Signature::addFluents(std::size_t index, const std::set<std::string>& with_elsewhere)
{
  Symbol& symbol = symbols_[index];
  symbol.offset = fluents_.size();
  if (symbol.size == 0)
  {
    return;
  }
  std::vector<std::size_t> digits(symbol.argument_sorts.size(), 0);
  do
  {
    PhysicalFluent fluent;
    fluent.symbol = index;
    fluent.defined = symbol.defined;
    fluent.values = symbol.value_sort->elements();
    reasoner::Atom atom{symbol.name, {}, {}};
    for (std::size_t i = 0; i < digits.size(); ++i)
    {
      fluent.arguments.push_back(symbol.argument_sorts[i]->elements()[digits[i]]);
      atom.arguments.push_back({false, vocabulary_.name(fluent.arguments.back())});
    }
    fluent.name = reasoner::toString(atom);
    if (with_elsewhere.count(fluent.name) > 0)
    {
      fluent.values.push_back(elsewhere_);
    }
    fluent_index_.emplace(fluent.name, fluents_.size());
    fluents_.push_back(std::move(fluent));
  } while (advance(digits, symbol.argument_sorts));
}

std::optional<std::size_t> Signature::findSymbol(const std::string& name) const
{
  const auto entry = symbol_index_.find(name);
  return entry == symbol_index_.end() ? std::nullopt : std::optional<std::size_t>(entry->second);
}

std::optional<std::size_t> Signature::findFluent(const std::string& name) const
{
  const auto entry = fluent_index_.find(name);
  return entry == fluent_index_.end() ? std::nullopt : std::optional<std::size_t>(entry->second);
}

std::optional<std::size_t> Signature::instance(const Symbol& symbol,
                                               const std::vector<Slot>& arguments,
                                               const Binding& binding) const
{
  if (symbol.size == 0)
  {
    return std::nullopt;
  }
  std::size_t index = 0;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    const int constant = constantOf(arguments[i], binding);
    const std::vector<int>& positions = symbol.positions[i];
    if (constant < 0 || static_cast<std::size_t>(constant) >= positions.size() ||
        positions[static_cast<std::size_t>(constant)] < 0)
    {
      return std::nullopt;
    }
    const ConstantSet& sort =
        symbol.is_static ? *symbol.full_argument_sorts[i] : *symbol.argument_sorts[i];
    index = index * sort.elements().size() +
            static_cast<std::size_t>(positions[static_cast<std::size_t>(constant)]);
  }
  return symbol.offset + index;
}

std::optional<std::size_t> Signature::fluentIndex(const CompiledLiteral& literal,
                                                  const Binding& binding) const
{
  const Symbol& symbol = symbols_[literal.symbol];
  return symbol.is_static ? std::nullopt : instance(symbol, literal.arguments, binding);
}

int Signature::value(const CompiledLiteral& literal, const Binding& binding,
                     const Values& state) const
{
  const Symbol& symbol = symbols_[literal.symbol];
  const std::optional<std::size_t> index = instance(symbol, literal.arguments, binding);
  if (!index)
  {
    return Vocabulary::kNone;
  }
  return symbol.is_static ? static_values_[*index] : state[*index];
}

Equality Signature::equality(int left, int right, const ConstantSet& kept,
                             const ConstantSet& full) const
{
  if (!isElsewhere(left) && !isElsewhere(right))
  {
    return left == right ? Equality::kEqual : Equality::kDifferent;
  }
  if (&full == &truth_values_)
  {
    return Equality::kUndetermined;
  }
  const int other = isElsewhere(left) ? right : left;
  if (!isElsewhere(other) && (kept.contains(other) || !full.contains(other)))
  {
    return Equality::kDifferent;
  }
  return full.elements().size() == kept.elements().size() + 1 ? Equality::kEqual
                                                              : Equality::kUndetermined;
}

void Signature::setStatic(const CompiledLiteral& literal, const Binding& binding, int value)
{
  const std::optional<std::size_t> index =
      instance(symbols_[literal.symbol], literal.arguments, binding);
  if (index)
  {
    static_values_[*index] = value;
  }
}

}  // namespace kr3::refinement
