#include <map>
#include <random>

#include "ground_domain.hpp"
#include "random_case.hpp"

namespace kr3::reasoner
{

std::string randomHistory(const Description& description, std::uint64_t seed, int steps,
                          int observations)
{
  std::mt19937_64 random(seed);
  const auto below = [&](std::size_t count) { return random() % count; };
  const oracle::GroundDomain domain = oracle::grounded(description);
  std::vector<std::string> agent_actions;
  for (const oracle::GroundActionInfo& action : domain.actions)
  {
    if (!action.exogenous)
    {
      agent_actions.push_back(action.name);
    }
  }
  std::string text;
  for (int step = 0; step < steps && !agent_actions.empty(); ++step)
  {
    text += "attempt(" + agent_actions[below(agent_actions.size())] + ", " + std::to_string(step) +
            ").\n";
  }
  std::map<std::size_t, int> world;
  for (int i = 0; i < observations; ++i)
  {
    const std::size_t index = below(domain.fluents.size());
    const oracle::GroundFluentInfo& fluent = domain.fluents[index];
    const auto drawn = static_cast<int>(below(fluent.values.size()));
    const int now = world.emplace(index, drawn).first->second;
    const oracle::GroundLiteral said{static_cast<int>(index), below(4) == 0 ? drawn : now, true};
    const int told =
        fluent.boolean || below(3) > 0 ? said.value : static_cast<int>(below(fluent.values.size()));
    text += "obs(" + oracle::toString(oracle::GroundLiteral{said.fluent, told, true}, domain) +
            (told == said.value ? ", true, " : ", false, ") +
            std::to_string(below(static_cast<std::size_t>(steps) + 1)) + ")" +
            (below(5) == 0 ? " [0.9].\n" : ".\n");
  }
  return text;
}

}  // namespace kr3::reasoner
