#include "models.hpp"

#include <string>
#include <vector>

#include "kr3_pomdp/model_builder.hpp"

namespace kr3::pomdp::test
{

Model tiger(double discount)
{
  ModelBuilder builder({"left", "right"}, {"listen", "open_left", "open_right"},
                       {"hear_left", "hear_right"});
  builder.setDiscount(discount);
  for (std::size_t s = 0; s < 2; ++s)
  {
    builder.setTransition(0, s, s, 1.0);
    builder.setObservation(0, s, s, 0.85);
    builder.setObservation(0, s, 1 - s, 0.15);
    builder.setReward(0, s, -1.0);
    for (std::size_t open = 1; open < 3; ++open)
    {
      builder.setTransition(open, s, kAny, 0.5);
      builder.setObservation(open, s, kAny, 0.5);
      builder.setReward(open, s, open == s + 1 ? -100.0 : 10.0);
    }
  }
  return builder.build();
}

Model roomSearch(std::size_t width)
{
  const std::size_t cells = width * width;
  const std::size_t places = cells + 1;  // the last is elsewhere
  std::vector<std::string> states;
  std::vector<std::string> actions;
  std::vector<std::string> observations{"none", "yes", "no"};
  for (std::size_t r = 0; r < cells; ++r)
  {
    for (std::size_t o = 0; o < places; ++o)
    {
      states.push_back("r" + std::to_string(r) + "o" + std::to_string(o));
    }
    actions.push_back("move" + std::to_string(r));
    observations.push_back("at" + std::to_string(r));
  }
  states.emplace_back("done");
  actions.insert(actions.end(), {"search", "grasp", "finish"});
  const std::size_t done = states.size() - 1;
  const std::size_t search = cells;
  const std::size_t grasp = cells + 1;
  const std::size_t finish = cells + 2;
  const auto state = [places](std::size_t r, std::size_t o) { return r * places + o; };
  const auto distance = [width](std::size_t i, std::size_t k) {
    const auto step = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
    return step(i % width, k % width) + step(i / width, k / width);
  };

  ModelBuilder builder(states, actions, observations);
  builder.setDiscount(0.98);
  std::vector<double> start(states.size(), 0.0);
  for (std::size_t o = 0; o < places; ++o)
  {
    start[state(0, o)] = 1.0 / static_cast<double>(places);
  }
  builder.setInitialBelief(start);
  for (std::size_t a = 0; a < actions.size(); ++a)
  {
    builder.setTransition(a, done, done, 1.0);
    builder.setObservation(a, done, a == grasp ? 1 : 0, 1.0);
  }
  for (std::size_t r = 0; r < cells; ++r)
  {
    for (std::size_t o = 0; o < places; ++o)
    {
      const std::size_t s = state(r, o);
      for (std::size_t k = 0; k < cells; ++k)
      {
        std::vector<std::size_t> near;
        for (std::size_t q = 0; q < cells; ++q)
        {
          if (distance(q, k) == 1)
          {
            near.push_back(q);
          }
        }
        builder.setTransition(k, s, state(k, o), 0.95);
        for (const std::size_t q : near)
        {
          builder.setTransition(k, s, state(q, o), 0.05 / static_cast<double>(near.size()));
        }
        builder.setObservation(k, s, 3 + r, 1.0);
        builder.setReward(k, s, -1.0 - static_cast<double>(distance(r, k)));
      }
      const bool here = r == o;
      builder.setTransition(search, s, s, 1.0);
      builder.setObservation(search, s, 1, here ? 0.90 : 0.05);
      builder.setObservation(search, s, 2, here ? 0.10 : 0.95);
      builder.setReward(search, s, -2.0);
      builder.setTransition(finish, s, done, 1.0);
      builder.setObservation(finish, s, 0, 1.0);
      builder.setReward(finish, s, o == cells ? 20.0 : -100.0);
      builder.setObservation(grasp, s, 2, 1.0);
      builder.setTransition(grasp, s, s, here ? 0.1 : 1.0);
      builder.setTransition(grasp, s, done, here ? 0.9 : 0.0);
      builder.setReward(grasp, s, s, kAny, here ? -4.0 : -12.0);
      builder.setReward(grasp, s, done, kAny, 100.0);
    }
  }
  return builder.build();
}

}  // namespace kr3::pomdp::test
