#include "preferences.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <unordered_map>

#include "diagnostics.hpp"

namespace kr3::reasoner
{

namespace
{

/// The defaults as a graph: an edge from the better to the worse. Finds the strongly connected
/// components (Tarjan 1972), without recursion.
class Components
{
public:
  explicit Components(const std::vector<std::vector<std::size_t>>& edges)
    : edges_(edges), number_(edges.size(), 0), lowest_(edges.size(), 0), component_(edges.size(), 0)
  {
    for (std::size_t node = 0; node < edges.size(); ++node)
    {
      if (number_[node] == 0)
      {
        visit(node);
      }
    }
  }

  [[nodiscard]] bool together(std::size_t a, std::size_t b) const
  {
    return component_[a] == component_[b];
  }

private:
  struct Visit
  {
    std::size_t node;
    std::size_t next_edge;
  };

  void enter(std::size_t node)
  {
    number_[node] = lowest_[node] = ++last_number_;
    open_.push_back(node);
    path_.push_back({node, 0});
  }

  void visit(std::size_t root)
  {
    enter(root);
    while (!path_.empty())
    {
      const std::size_t node = path_.back().node;
      if (path_.back().next_edge < edges_[node].size())
      {
        const std::size_t next = edges_[node][path_.back().next_edge++];
        if (number_[next] == 0)
        {
          enter(next);
        }
        else if (component_[next] == 0)
        {
          lowest_[node] = std::min(lowest_[node], number_[next]);
        }
        continue;
      }
      path_.pop_back();
      if (!path_.empty())
      {
        const std::size_t parent = path_.back().node;
        lowest_[parent] = std::min(lowest_[parent], lowest_[node]);
      }
      if (lowest_[node] == number_[node])
      {
        close(node);
      }
    }
  }

  void close(std::size_t node)
  {
    ++last_component_;
    while (component_[node] == 0)
    {
      component_[open_.back()] = last_component_;
      open_.pop_back();
    }
  }

  const std::vector<std::vector<std::size_t>>& edges_;
  std::vector<std::size_t> number_;
  std::vector<std::size_t> lowest_;
  std::vector<std::size_t> component_;
  std::vector<std::size_t> open_;
  std::vector<Visit> path_;
  std::size_t last_number_ = 0;
  std::size_t last_component_ = 0;
};

}  // namespace

void checkPreferences(const Description& description, std::vector<Diagnostic>& problems)
{
  std::unordered_map<std::string, std::size_t> index;
  std::vector<std::size_t> arity;
  std::vector<std::string> names;
  for (const Default& rule : description.defaults)
  {
    if (!index.emplace(rule.name.name, names.size()).second)
    {
      problems.push_back({rule.position, "the default '" + rule.name.name + "' is declared twice"});
      continue;
    }
    arity.push_back(rule.name.arguments.size());
    names.push_back(rule.name.name);
  }
  constexpr std::size_t kEnough = 100;
  const auto isKnown = [&](const Atom& atom) {
    const auto found = index.find(atom.name);
    if (found == index.end())
    {
      problems.push_back(
          {atom.position, "unknown default '" + atom.name + "'" +
                              (problems.size() < kEnough ? suggestion(atom.name, names) : "")});
      return false;
    }
    if (arity[found->second] != atom.arguments.size())
    {
      problems.push_back({atom.position, "found " + std::to_string(atom.arguments.size()) +
                                             " arguments of the default " + atom.name +
                                             ", expected " + std::to_string(arity[found->second])});
    }
    return true;
  };
  std::vector<std::vector<std::size_t>> worse(names.size());
  std::vector<const Preference*> known;
  for (const Preference& preference : description.preferences)
  {
    const bool better_known = isKnown(preference.better);
    if (isKnown(preference.worse) && better_known)
    {
      worse[index.at(preference.better.name)].push_back(index.at(preference.worse.name));
      known.push_back(&preference);
    }
  }
  const Components components(worse);
  for (const Preference* preference : known)
  {
    if (components.together(index.at(preference->better.name), index.at(preference->worse.name)))
    {
      problems.push_back({preference->position, "the preference of " + preference->better.name +
                                                    " over " + preference->worse.name +
                                                    " closes a cycle, expected an order"});
    }
  }
}

}  // namespace kr3::reasoner
