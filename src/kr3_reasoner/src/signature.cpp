#include "signature.hpp"

namespace kr3::reasoner
{

Signature::Signature(const Vocabulary& vocabulary, bool exogenous) : vocabulary_(vocabulary)
{
  for (const FluentDeclaration& fluent : vocabulary.description().fluents)
  {
    Instances instances;
    instances.first = num_values_;
    instances.present = fluent.kind != FluentKind::kStatic;
    instances.num_values = 2;
    if (fluent.value_sort)
    {
      instances.value_sort = vocabulary.sortIndex(*fluent.value_sort);
      instances.num_values = vocabulary.elements(instances.value_sort).size();
    }
    count(instances, fluent.argument_sorts, instances.num_values);
    num_values_ += instances.present ? instances.size : 0;
    fluents_.push_back(std::move(instances));
  }
  for (const ActionDeclaration& action : vocabulary.description().actions)
  {
    Instances instances;
    instances.first = num_actions_;
    instances.present = exogenous || !action.exogenous;
    count(instances, action.argument_sorts, 1);
    num_actions_ += instances.present ? instances.size : 0;
    actions_.push_back(std::move(instances));
  }
}

void Signature::count(Instances& instances, const std::vector<std::string>& sorts,
                      std::size_t innermost) const
{
  instances.size = innermost;
  instances.strides.resize(sorts.size());
  instances.sorts.resize(sorts.size());
  for (std::size_t i = sorts.size(); i-- > 0;)
  {
    instances.sorts[i] = vocabulary_.sortIndex(sorts[i]);
    instances.strides[i] = instances.size;
    instances.size *= vocabulary_.elements(instances.sorts[i]).size();
  }
}

int Signature::number(const Instances& instances, const std::vector<Slot>& arguments,
                      const RuleBinding& binding) const
{
  std::size_t number = instances.first;
  for (std::size_t i = 0; i < arguments.size(); ++i)
  {
    const int position = vocabulary_.position(bound(arguments[i], binding), instances.sorts[i]);
    if (position < 0)
    {
      return -1;
    }
    number += static_cast<std::size_t>(position) * instances.strides[i];
  }
  return static_cast<int>(number);
}

int Signature::value(int fluent, const std::vector<Slot>& arguments, const Slot& value,
                     const RuleBinding& binding) const
{
  const Instances& instances = fluents_[fluent];
  const ConstantId constant = bound(value, binding);
  const int position = instances.value_sort == kBoolean
                           ? constant
                           : vocabulary_.position(constant, instances.value_sort);
  const int first = position < 0 ? -1 : number(instances, arguments, binding);
  return first < 0 ? -1 : first + position;
}

int Signature::action(int action, const std::vector<Slot>& arguments,
                      const RuleBinding& binding) const
{
  return number(actions_[action], arguments, binding);
}

}  // namespace kr3::reasoner
