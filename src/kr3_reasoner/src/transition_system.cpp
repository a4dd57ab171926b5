#include "kr3_reasoner/transition_system.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <kr3_common/error.hpp>

#include "encoding.hpp"
#include "ground_fluents.hpp"
#include "solver.hpp"

namespace kr3::reasoner
{

namespace
{

/// Reads states, actions and labels out of models. An atom means the same in every model, so it is
/// decoded once, and a model is read by the truth of the solver's literals.
class ModelReader
{
public:
  ModelReader(const Description& description, const std::vector<GroundFluent>& fluents,
              const std::vector<std::string>& actions)
    : description_(description)
  {
    for (std::size_t i = 0; i < fluents.size(); ++i)
    {
      fluent_index_.emplace(fluents[i].name, i);
      for (std::size_t v = 0; v < fluents[i].values.size(); ++v)
      {
        value_index_[i].emplace(fluents[i].values[v], static_cast<int>(v));
      }
    }
    for (std::size_t i = 0; i < actions.size(); ++i)
    {
      action_index_.emplace(actions[i], i);
    }
    empty_.resize(fluents.size());
  }

  /// Decodes the atoms that grounding made. Call it again after more grounding.
  void decode(const Clingo::SymbolicAtoms& atoms)
  {
    values_.clear();
    occurrences_.clear();
    labels_.clear();
    for (auto it = atoms.begin(Clingo::Signature("h", 3)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      const std::size_t fluent = fluent_index_.at(toText(arguments[0]));
      values_.push_back({it->literal(), fluent, value_index_.at(fluent).at(toText(arguments[1])),
                         arguments[2].number()});
    }
    for (auto it = atoms.begin(Clingo::Signature("occ", 2)); it; ++it)
    {
      occurrences_.push_back(
          {it->literal(), action_index_.at(toText(it->symbol().arguments()[0]))});
    }
    for (auto it = atoms.begin(Clingo::Signature("out", 5)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      const auto law = static_cast<std::size_t>(arguments[0].number());
      const auto outcome = static_cast<std::size_t>(arguments[1].number());
      labels_.push_back({it->literal(), toText(arguments[3]),
                         description_.causal_laws[law].outcomes[outcome].label});
    }
  }

  [[nodiscard]] State state(const Clingo::Model& model, int step) const
  {
    State state = empty_;  // false for defined fluents that no definition makes true
    for (const ValueAtom& atom : values_)
    {
      if (atom.step == step && model.is_true(atom.literal))
      {
        state[atom.fluent] = atom.value;
      }
    }
    return state;
  }

  [[nodiscard]] std::size_t action(const Clingo::Model& model) const
  {
    const auto found =
        std::find_if(occurrences_.begin(), occurrences_.end(),
                     [&](const auto& occurrence) { return model.is_true(occurrence.literal); });
    return found->action;
  }

  [[nodiscard]] std::map<std::string, std::string> outcomes(const Clingo::Model& model) const
  {
    std::map<std::string, std::string> taken;
    for (const LabelAtom& atom : labels_)
    {
      if (!atom.label.empty() && model.is_true(atom.literal))
      {
        taken.emplace(atom.action, atom.label);
      }
    }
    return taken;
  }

private:
  struct ValueAtom
  {
    Clingo::literal_t literal;
    std::size_t fluent;
    int value;
    int step;
  };
  struct OccurrenceAtom
  {
    Clingo::literal_t literal;
    std::size_t action;
  };
  struct LabelAtom
  {
    Clingo::literal_t literal;
    std::string action;
    std::string label;
  };

  const Description& description_;
  std::unordered_map<std::string, std::size_t> fluent_index_;
  std::unordered_map<std::size_t, std::unordered_map<std::string, int>> value_index_;
  std::unordered_map<std::string, std::size_t> action_index_;
  State empty_;
  std::vector<ValueAtom> values_;
  std::vector<OccurrenceAtom> occurrences_;
  std::vector<LabelAtom> labels_;
};

}  // namespace

TransitionSystem::TransitionSystem(const Description& description, std::size_t max_states)
  : fluents_(groundFluents(description))
{
  for (const ActionDeclaration& action : description.actions)
  {
    if (!action.exogenous)
    {
      const auto instances = groundActions(action, description);
      actions_.insert(actions_.end(), instances.begin(), instances.end());
    }
  }
  const Encoding encoding(description);
  Solver solver({"0", "--warn=none"});
  solver.add("base", {}, encoding.signature() + Encoding::anyState());
  solver.add("state", {"_t"}, encoding.state());
  solver.add("trans", {"_t"}, encoding.transition());
  solver.add("act", {}, "1 { occ(_A,0) : agent(_A) } 1.\n");
  solver.ground({{"base", {}}, {"state", {0}}});
  ModelReader reader(description, fluents_, actions_);
  reader.decode(solver.control().symbolic_atoms());

  std::map<State, std::size_t> index;
  for (const Clingo::Model& model : solver.control().solve())
  {
    index.emplace(reader.state(model, 0), 0);
    if (index.size() > max_states)
    {
      throw ResourceExhausted("the transition system has more than " + std::to_string(max_states) +
                              " states");
    }
  }
  for (auto& [state, number] : index)
  {
    number = states_.size();
    states_.push_back(state);
  }
  successors_.assign(states_.size(), std::vector<std::vector<IndexedSuccessor>>(actions_.size()));
  executable_.assign(states_.size(), std::vector<bool>(actions_.size(), false));
  if (actions_.empty())
  {
    return;
  }

  solver.ground({{"act", {}}, {"trans", {1}}, {"state", {1}}});
  reader.decode(solver.control().symbolic_atoms());
  for (const Clingo::Model& model : solver.control().solve())
  {
    const std::size_t from = index.at(reader.state(model, 0));
    const std::size_t action = reader.action(model);
    IndexedSuccessor successor{index.at(reader.state(model, 1)), reader.outcomes(model)};
    auto& known = successors_[from][action];
    const bool fresh = std::none_of(known.begin(), known.end(), [&](const IndexedSuccessor& other) {
      return other.state == successor.state && other.outcomes == successor.outcomes;
    });
    if (fresh)
    {
      known.push_back(std::move(successor));
    }
    executable_[from][action] = true;
  }
  for (auto& row : successors_)
  {
    for (auto& cell : row)
    {
      std::sort(cell.begin(), cell.end(), [](const IndexedSuccessor& a, const IndexedSuccessor& b) {
        return std::tie(a.state, a.outcomes) < std::tie(b.state, b.outcomes);
      });
    }
  }
}

bool TransitionSystem::executable(std::size_t state, std::size_t action) const
{
  return executable_.at(state).at(action);
}

const std::vector<TransitionSystem::IndexedSuccessor>& TransitionSystem::successors(
    std::size_t state, std::size_t action) const
{
  return successors_.at(state).at(action);
}

}  // namespace kr3::reasoner
