#include "plan_program_store.hpp"

#include <algorithm>
#include <utility>

#include "plan_program.hpp"

namespace kr3::reasoner
{

PlanProgramStore::PlanProgramStore() = default;
PlanProgramStore::~PlanProgramStore() = default;

std::list<PlanProgramStore::Entry>::iterator PlanProgramStore::find(const std::string& key)
{
  return std::find_if(entries_.begin(), entries_.end(),
                      [&](const Entry& entry) { return entry.key == key; });
}

bool PlanProgramStore::isAskedAgain(const std::string& key)
{
  const auto found = find(key);
  if (found != entries_.end())
  {
    entries_.splice(entries_.begin(), entries_, found);
    return true;
  }
  entries_.push_front({key, nullptr});
  if (entries_.size() > kMost)
  {
    entries_.pop_back();
  }
  return false;
}

std::unique_ptr<PlanProgram> PlanProgramStore::take(const std::string& key)
{
  const auto found = find(key);
  return found == entries_.end() ? nullptr : std::move(found->program);
}

void PlanProgramStore::keep(const std::string& key, std::unique_ptr<PlanProgram> program)
{
  const auto found = find(key);
  if (found != entries_.end())
  {
    found->program = std::move(program);
  }
}

}  // namespace kr3::reasoner
