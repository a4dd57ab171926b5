#include "components.hpp"

#include <algorithm>

namespace kr3::reasoner
{

Components::Components(const std::vector<std::vector<std::size_t>>& edges)
  : number_(edges.size(), 0), lowest_(edges.size(), 0), component_(edges.size(), 0)
{
  for (std::size_t node = 0; node < edges.size(); ++node)
  {
    if (number_[node] == 0)
    {
      visit(node, edges);
    }
  }
}

void Components::enter(std::size_t node)
{
  number_[node] = lowest_[node] = ++last_number_;
  open_.push_back(node);
  path_.push_back({node, 0});
}

void Components::visit(std::size_t root, const std::vector<std::vector<std::size_t>>& edges)
{
  enter(root);
  while (!path_.empty())
  {
    const std::size_t node = path_.back().node;
    if (path_.back().next_edge < edges[node].size())
    {
      const std::size_t next = edges[node][path_.back().next_edge++];
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

void Components::close(std::size_t node)
{
  ++last_component_;
  while (component_[node] == 0)
  {
    component_[open_.back()] = last_component_;
    open_.pop_back();
  }
}

}  // namespace kr3::reasoner
