#include "pomdpx_writer.hpp"

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "kr3_pomdp/pomdpx_format.hpp"

namespace kr3::pomdp
{

namespace
{

template <typename NameOf>
std::vector<std::string> namesOf(std::size_t count, const NameOf& name_of)
{
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i)
  {
    names.push_back(name_of(i));
  }
  return pomdpxNames(names);
}

/// A flat model as one state variable.
class FlatWriter
{
public:
  FlatWriter(std::ostream& out, const Model& model)
    : xml_(out, model.discount())
    , model_(model)
    , labels_(model.initialLabels().begin(), model.initialLabels().end())
    , states_(namesOf(model.numStates(), [&](std::size_t i) { return model.stateName(i); }))
    , actions_(namesOf(model.numActions(), [&](std::size_t i) { return model.actionName(i); }))
    , observations_(
          namesOf(model.numObservations(), [&](std::size_t i) { return model.observationName(i); }))
  {
  }

  void write()
  {
    variables();
    initialBelief();
    transitions();
    observations();
    rewards();
    xml_.end();
  }

private:
  [[nodiscard]] bool sees() const { return labels_.size() > 1; }

  void variables()
  {
    xml_.open("Variable");
    xml_.stateVariable("state_0", "state_1", false, states_);
    if (sees())
    {
      // What is seen first; nothing afterwards.
      std::vector<std::string> seen;
      for (const std::uint32_t label : labels_)
      {
        seen.push_back("first" + std::to_string(label));
      }
      seen.emplace_back("later");
      xml_.stateVariable("seen_0", "seen_1", true, seen);
    }
    xml_.variable("ActionVar", "action", actions_);
    xml_.variable("ObsVar", "observation", observations_);
    xml_.rewardVariable("reward");
    xml_.close("Variable");
  }

  void initialBelief()
  {
    xml_.open("InitialStateBelief");
    xml_.openTable(false,
                   sees() ? std::vector<std::string>{"state_0", "seen_0"}
                          : std::vector<std::string>{"state_0"},
                   {});
    for (std::size_t s = 0; s < states_.size(); ++s)
    {
      if (model_.initialBelief()[s] > 0.0)
      {
        const std::string seen =
            sees() ? " first" + std::to_string(model_.initialLabels()[s]) : std::string();
        xml_.entry(states_[s] + seen, {model_.initialBelief()[s]});
      }
    }
    xml_.closeTable();
    xml_.close("InitialStateBelief");
  }

  /// A table of rows by action and state.
  template <typename RowOf>
  void table(const char* of, const char* state, const std::vector<std::string>& columns,
             const RowOf& row_of)
  {
    xml_.openTable(false, {of}, {"action", state});
    for (std::size_t a = 0; a < actions_.size(); ++a)
    {
      for (std::size_t s = 0; s < states_.size(); ++s)
      {
        for (const SparseEntry& entry : row_of(a, s))
        {
          xml_.entry(actions_[a] + " " + states_[s] + " " + columns[entry.index],
                     {entry.probability});
        }
      }
    }
    xml_.closeTable();
  }

  void transitions()
  {
    xml_.open("StateTransitionFunction");
    table("state_1", "state_0", states_,
          [this](std::size_t a, std::size_t s) { return model_.transitions(a, s); });
    if (sees())
    {
      xml_.openTable(false, {"seen_1"}, {});
      xml_.entry("later", {1.0});
      xml_.closeTable();
    }
    xml_.close("StateTransitionFunction");
  }

  void observations()
  {
    xml_.open("ObsFunction");
    table("observation", "state_1", observations_,
          [this](std::size_t a, std::size_t s) { return model_.observations(a, s); });
    xml_.close("ObsFunction");
  }

  void rewards()
  {
    xml_.open("RewardFunction");
    xml_.openTable(true, {"reward"}, {"action", "state_0"});
    for (std::size_t a = 0; a < actions_.size(); ++a)
    {
      for (std::size_t s = 0; s < states_.size(); ++s)
      {
        if (model_.reward(a, s) != 0.0)
        {
          xml_.entry(actions_[a] + " " + states_[s], {model_.reward(a, s)});
        }
      }
    }
    xml_.closeTable();
    xml_.close("RewardFunction");
  }

  PomdpxElements xml_;
  const Model& model_;
  std::set<std::uint32_t> labels_;
  std::vector<std::string> states_;
  std::vector<std::string> actions_;
  std::vector<std::string> observations_;
};

}  // namespace

void writePomdpx(std::ostream& out, const Model& model)
{
  FlatWriter(out, model).write();
}

}  // namespace kr3::pomdp
