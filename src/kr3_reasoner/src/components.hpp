#pragma once

#include <cstddef>
#include <vector>

namespace kr3::reasoner
{

/// The strongly connected components of a graph (Tarjan 1972), found without recursion. Private to
/// the package.
class Components
{
public:
  /// @param edges  by node: the nodes that its edges lead to
  explicit Components(const std::vector<std::vector<std::size_t>>& edges);

  /// Whether each of two nodes can be reached from the other; true of a node and itself.
  [[nodiscard]] bool together(std::size_t a, std::size_t b) const
  {
    return component_[a] == component_[b];
  }

  /// Number of a node's component, from 1: an edge leads to the same or a smaller one.
  [[nodiscard]] std::size_t component(std::size_t node) const { return component_[node]; }
  [[nodiscard]] std::size_t numComponents() const { return last_component_; }

private:
  struct Visit
  {
    std::size_t node;
    std::size_t next_edge;
  };

  void visit(std::size_t root, const std::vector<std::vector<std::size_t>>& edges);
  void enter(std::size_t node);
  void close(std::size_t node);

  std::vector<std::size_t> number_;
  std::vector<std::size_t> lowest_;
  std::vector<std::size_t> component_;
  std::vector<std::size_t> open_;
  std::vector<Visit> path_;
  std::size_t last_number_ = 0;
  std::size_t last_component_ = 0;
};

}  // namespace kr3::reasoner
