#include "kr3_executive/task_cache.hpp"

#include <cstring>
#include <utility>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

using reasoner::Literal;
using refinement::Distribution;

void addKey(Fingerprinter& fingerprinter, const Fingerprint& key)
{
  fingerprinter.add(key.high);
  fingerprinter.add(key.low);
}

void addAtom(Fingerprinter& fingerprinter, const reasoner::Atom& atom)
{
  fingerprinter.addText(atom.name);
  fingerprinter.add(static_cast<std::uint64_t>(atom.arguments.size()));
  for (const auto& argument : atom.arguments)
    fingerprinter.addText(argument.name);
}

void addLiterals(Fingerprinter& fingerprinter, const std::vector<Literal>& literals)
{
  fingerprinter.add(static_cast<std::uint64_t>(literals.size()));
  for (const Literal& literal : literals)
  {
    addAtom(fingerprinter, literal.atom);
    fingerprinter.add(static_cast<std::uint64_t>(literal.equal ? 1 : 0));
    fingerprinter.addText(literal.value.name);
  }
}

void addDistributions(Fingerprinter& fingerprinter,
                      const std::map<std::string, Distribution>& distributions)
{
  fingerprinter.add(static_cast<std::uint64_t>(distributions.size()));
  for (const auto& [fluent, values] : distributions)
  {
    fingerprinter.addText(fluent);
    fingerprinter.add(static_cast<std::uint64_t>(values.size()));
    for (const auto& [value, probability] : values)
    {
      fingerprinter.addText(value);
      std::uint64_t bits = 0;  // all of them count
      std::memcpy(&bits, &probability, sizeof bits);
      fingerprinter.add(bits);
    }
  }
}

Fingerprint keyOf(const HighLevelState& state, const std::string& action)
{
  Fingerprinter fingerprinter;
  addKey(fingerprinter, state.key);
  fingerprinter.addText(action);
  return fingerprinter.result();
}

Fingerprint keyOf(const refinement::Zoom& zoom)
{
  Fingerprinter fingerprinter;
  fingerprinter.addText(zoom.action);
  addLiterals(fingerprinter, zoom.start);
  addLiterals(fingerprinter, zoom.effects);
  fingerprinter.add(static_cast<std::uint64_t>(zoom.relevant.size()));
  for (const auto& constant : zoom.relevant)
  {
    fingerprinter.addText(constant.name);
    fingerprinter.addText(constant.reason);
  }
  fingerprinter.add(static_cast<std::uint64_t>(zoom.constants.size()));
  for (const auto& constant : zoom.constants)
    fingerprinter.addText(constant);
  return fingerprinter.result();
}

std::size_t sizeOf(const std::vector<Literal>& literals)
{
  constexpr std::size_t kOfArguments = 2 * sizeof(reasoner::Term);
  return literals.size() * (sizeof(Literal) + kOfArguments);
}

std::size_t sizeOf(const refinement::PomdpTask& task)
{
  // Rows that are equal are shared; the names and the states' values count like as many entries.
  const auto& model = task.model();
  const std::size_t rows = model.numStates() * model.numActions();
  constexpr std::size_t kOfRow = 2 * sizeof(std::uint32_t) + sizeof(double) + 1;
  constexpr std::size_t kOfState = 200;
  constexpr std::size_t kOfAction = 600;
  return sizeof task + rows * kOfRow + model.numStates() * kOfState +
         model.numActions() * kOfAction;
}

}  // namespace

HighLevelState highLevelState(std::vector<Literal> literals)
{
  Fingerprinter fingerprinter;
  addLiterals(fingerprinter, literals);
  return {std::move(literals), fingerprinter.result()};
}

std::shared_ptr<const KnownZoom> TaskCache::zoom(const HighLevelState& state,
                                                 const std::string& action)
{
  const Fingerprint key = keyOf(state, action);
  auto known = zooms_.find(key);
  if (!known)
  {
    Outcome<KnownZoom> outcome;
    try
    {
      KnownZoom zoomed{refinement::zoom(domain_, state.literals,
                                        reasoner::parseGroundAction(action, domain_.highLevel())),
                       {}};
      zoomed.key = keyOf(zoomed.zoom);
      outcome.value = std::make_shared<const KnownZoom>(std::move(zoomed));
    }
    catch (const FailedPrecondition& e)
    {
      outcome.refusal = e.what();
    }
    const std::size_t bytes =
        outcome.value
            ? sizeof(KnownZoom) + sizeOf(outcome.value->zoom.start) +
                  sizeOf(outcome.value->zoom.effects) +
                  100 * (outcome.value->zoom.relevant.size() + outcome.value->zoom.constants.size())
            : outcome.refusal.size();
    known = zooms_.keep(key, std::move(outcome), bytes);
  }
  if (!known->value)
    throw FailedPrecondition(known->refusal);
  return known->value;
}

std::shared_ptr<const HighLevelState> TaskCache::successor(const HighLevelState& state,
                                                           const std::string& action)
{
  const Fingerprint key = keyOf(state, action);
  auto known = successors_.find(key);
  if (!known)
  {
    Outcome<HighLevelState> outcome;
    try
    {
      outcome.value = std::make_shared<const HighLevelState>(highLevelState(
          refinement::successor(domain_.highLevel(), state.literals,
                                reasoner::parseGroundAction(action, domain_.highLevel()))));
    }
    catch (const FailedPrecondition& e)
    {
      outcome.refusal = e.what();
    }
    const std::size_t bytes =
        outcome.value ? sizeOf(outcome.value->literals) : outcome.refusal.size();
    known = successors_.keep(key, std::move(outcome), bytes);
  }
  if (!known->value)
    throw FailedPrecondition(known->refusal);
  return known->value;
}

std::shared_ptr<const refinement::PomdpTask> TaskCache::task(
    const KnownZoom& zoom, const refinement::InitialKnowledge& knowledge)
{
  Fingerprinter fingerprinter;
  addKey(fingerprinter, zoom.key);
  addDistributions(fingerprinter, knowledge.fine);
  addDistributions(fingerprinter, knowledge.coarse);
  const Fingerprint key = fingerprinter.result();
  if (const auto known = tasks_.find(key))
    return *known;
  auto task = std::make_shared<const refinement::PomdpTask>(
      refinement::generatePomdp(domain_, models_, zoom.zoom, knowledge));
  const std::size_t bytes = sizeOf(*task);
  return *tasks_.keep(key, std::move(task), bytes);
}

}  // namespace kr3::executive
