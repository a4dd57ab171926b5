// Policy graphs in the DOT language.

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "kr3_pomdp/policy_graph.hpp"

namespace kr3::pomdp
{

namespace
{

constexpr std::size_t kStatesShown = 3;
constexpr std::size_t kObservationsShown = 4;
// Light enough for black text, in the order in which actions have them.
constexpr std::array<const char*, 8> kColours = {"#cfe2f3", "#d9ead3", "#fff2cc", "#f4cccc",
                                                 "#d9d2e9", "#d0e0e3", "#fce5cd", "#ead1dc"};

/// A number as a person reads it: three digits, more only where they say something.
std::string brief(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

std::string escaped(const std::string& text)
{
  std::string result;
  for (const char c : text)
  {
    if (c == '"' || c == '\\')
    {
      result += '\\';
    }
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string labelOf(const PolicyGraph::Node& node, const Model& model)
{
  std::string label = escaped(model.actionName(node.action));
  if (node.end == PolicyGraph::End::kFinished)
  {
    label = "finished";
  }
  label += "\\nvalue " + brief(node.value);
  std::vector<SparseEntry> likely = node.belief;
  std::stable_sort(likely.begin(), likely.end(), [](const SparseEntry& a, const SparseEntry& b) {
    return a.probability > b.probability;
  });
  for (std::size_t i = 0; i < std::min(likely.size(), kStatesShown); ++i)
  {
    label += "\\n" + escaped(model.stateName(likely[i].index)) + " " + brief(likely[i].probability);
  }
  if (likely.size() > kStatesShown)
  {
    label += "\\nand " + std::to_string(likely.size() - kStatesShown) + " more";
  }
  return label;
}

/// The observations from one node to another, the likeliest first.
std::string labelOf(std::vector<PolicyGraph::Edge> edges, const Model& model)
{
  std::stable_sort(edges.begin(), edges.end(),
                   [](const PolicyGraph::Edge& a, const PolicyGraph::Edge& b) {
    return a.probability > b.probability;
  });
  std::string label;
  double rest = 0.0;
  for (std::size_t i = 0; i < edges.size(); ++i)
  {
    if (i < kObservationsShown || edges.size() == kObservationsShown + 1)
    {
      label += (label.empty() ? "" : "\\n") + escaped(model.observationName(edges[i].observation)) +
               " " + brief(edges[i].probability);
    }
    else
    {
      rest += edges[i].probability;
    }
  }
  if (rest > 0.0)
  {
    label += "\\n" + std::to_string(edges.size() - kObservationsShown) + " more " + brief(rest);
  }
  return label;
}

}  // namespace

void writeDot(std::ostream& out, const PolicyGraph& graph, const Model& model)
{
  out << "digraph policy {\n"
      << "  graph [rankdir=TB, nodesep=0.3, ranksep=0.5];\n"
      << "  node [shape=box, style=\"rounded,filled\", fontname=\"Helvetica\", fontsize=11];\n"
      << "  edge [fontname=\"Helvetica\", fontsize=9];\n";
  std::map<std::size_t, std::size_t> colours;  // of the actions, in the order of their first node
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
  {
    const PolicyGraph::Node& node = graph.nodes[i];
    const bool finished = node.end == PolicyGraph::End::kFinished;
    const std::size_t number = colours.emplace(node.action, colours.size()).first->second;
    out << "  n" << i << " [label=\"" << labelOf(node, model) << "\", fillcolor=\""
        << (finished ? "#ffffff" : kColours[number % kColours.size()]) << '"'
        << (finished ? ", peripheries=2" : "")
        << (node.end == PolicyGraph::End::kLimit ? ", style=\"rounded,filled,dashed\"" : "")
        << "];\n";
  }
  for (std::size_t i = 0; i < graph.starts.size(); ++i)
  {
    out << "  start" << i << " [shape=point, width=0.12];\n  start" << i << " -> n"
        << graph.starts[i].node;
    if (graph.starts.size() > 1)
    {
      out << " [label=\"" << brief(graph.starts[i].probability) << "\"]";
    }
    out << ";\n";
  }
  std::map<std::pair<std::size_t, std::size_t>, std::vector<PolicyGraph::Edge>> between;
  for (const PolicyGraph::Edge& edge : graph.edges)
  {
    between[{edge.from, edge.to}].push_back(edge);
  }
  for (const auto& [ends, edges] : between)
  {
    out << "  n" << ends.first << " -> n" << ends.second << " [label=\"" << labelOf(edges, model)
        << "\"];\n";
  }
  out << "}\n";
}

}  // namespace kr3::pomdp
