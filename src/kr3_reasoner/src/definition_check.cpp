#include "definition_check.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "components.hpp"
#include "diagnostics.hpp"
#include "encoding.hpp"
#include "history.hpp"
#include "solver.hpp"
#include "words.hpp"

namespace kr3::reasoner
{

namespace
{

/// A definition that needs a ground fluent, or static, to be true or not to be.
struct Dependency
{
  std::size_t head;
  std::size_t needed;
  bool negated;
  std::size_t rule;  ///< index into Description::constraints
};

struct Graph
{
  std::vector<std::string> nodes;
  std::vector<Dependency> dependencies;

  [[nodiscard]] Components components() const
  {
    std::vector<std::vector<std::size_t>> edges(nodes.size());
    for (const Dependency& dependency : dependencies)
    {
      edges[dependency.head].push_back(dependency.needed);
    }
    return Components(edges);
  }
};

class DefinitionChecker
{
public:
  DefinitionChecker(const Description& description, std::vector<Diagnostic>& problems)
    : description_(description), encoding_(description), problems_(problems)
  {
  }

  void run()
  {
    addNames();
    const Components components = names_.components();
    std::vector<const Dependency*> done;
    for (const Dependency& negative : names_.dependencies)
    {
      const bool known = std::any_of(done.begin(), done.end(), [&](const Dependency* other) {
        return components.together(other->head, negative.head);
      });
      if (negative.negated && !known && components.together(negative.head, negative.needed))
      {
        done.push_back(&negative);
        reportShortestCycle(ground(components, negative.head));
      }
    }
  }

private:
  [[nodiscard]] bool isDefined(const Literal& literal) const
  {
    const FluentKind kind = description_.findFluent(literal.atom.name)->kind;
    return kind == FluentKind::kDefined || kind == FluentKind::kStatic;
  }

  [[nodiscard]] bool isNegated(const Literal& open) const
  {
    const Literal literal = normalized(open, description_);
    return !literal.equal || (encoding_.isBoolean(literal) && literal.value.name == "false");
  }

  std::size_t nameIndex(const std::string& name)
  {
    const auto [place, fresh] = name_index_.emplace(name, names_.nodes.size());
    if (fresh)
    {
      names_.nodes.push_back(name);
    }
    return place->second;
  }

  /// The graph of the names, which most descriptions settle without grounding.
  void addNames()
  {
    for (std::size_t i = 0; i < description_.constraints.size(); ++i)
    {
      const StateConstraint& rule = description_.constraints[i];
      if (!rule.head || !isDefined(*rule.head))
      {
        continue;
      }
      const std::size_t head = nameIndex(rule.head->atom.name);
      for (const Condition& condition : rule.body)
      {
        const auto* literal = std::get_if<Literal>(&condition);
        if (literal != nullptr && isDefined(*literal))
        {
          names_.dependencies.push_back(
              {head, nameIndex(literal->atom.name), isNegated(*literal), i});
        }
      }
    }
  }

  /// The ground dependencies within one component of the names.
  [[nodiscard]] Graph ground(const Components& components, std::size_t member)
  {
    const auto isInside = [&](const Literal& literal) {
      const auto name = name_index_.find(literal.atom.name);
      return name != name_index_.end() && components.together(name->second, member);
    };
    std::string text = encoding_.vocabulary() + "#defined st/2. #defined edge/4.\n";
    for (std::size_t i = 0; i < description_.constraints.size(); ++i)
    {
      const StateConstraint& rule = description_.constraints[i];
      if (!rule.head || !isInside(*rule.head))
      {
        continue;
      }
      Body decided;  // before any state is known
      for (const Condition& condition : rule.body)
      {
        const auto* literal = std::get_if<Literal>(&condition);
        if (literal == nullptr ||
            (description_.findFluent(literal->atom.name)->kind == FluentKind::kStatic &&
             !isInside(*literal)))
        {
          decided.push_back(condition);
        }
      }
      Encoding::Guards guards(description_);
      guards.literal(*rule.head).body(rule.body);
      for (const Condition& condition : rule.body)
      {
        const auto* literal = std::get_if<Literal>(&condition);
        if (literal != nullptr && isInside(*literal))
        {
          text += "edge(" + Encoding::term(rule.head->atom) + "," + Encoding::term(literal->atom) +
                  "," + (isNegated(*literal) ? "1," : "0,") + std::to_string(i) + ") :- #true" +
                  guards.text() + encoding_.body(decided, "0") + ".\n";
        }
      }
    }
    Solver solver({"--warn=none"});
    solver.add("base", {}, text);
    solver.ground({{"base", {}}});
    Graph graph;
    std::unordered_map<Clingo::Symbol, std::size_t> index;
    const auto node = [&](const Clingo::Symbol& symbol) {
      const auto [place, fresh] = index.emplace(symbol, graph.nodes.size());
      if (fresh)
      {
        graph.nodes.push_back(toText(symbol));
      }
      return place->second;
    };
    const Clingo::SymbolicAtoms atoms = solver.control().symbolic_atoms();
    for (auto it = atoms.begin(Clingo::Signature("edge", 4)); it; ++it)
    {
      const auto arguments = it->symbol().arguments();
      graph.dependencies.push_back({node(arguments[0]), node(arguments[1]),
                                    arguments[2].number() == 1,
                                    static_cast<std::size_t>(arguments[3].number())});
    }
    std::sort(graph.dependencies.begin(), graph.dependencies.end(),
              [&](const Dependency& a, const Dependency& b) {
      return std::tie(a.rule, graph.nodes[a.head], graph.nodes[a.needed]) <
             std::tie(b.rule, graph.nodes[b.head], graph.nodes[b.needed]);
    });
    return graph;
  }

  /// The shortest way from a node to another, as dependencies; empty when they are one.
  [[nodiscard]] static std::vector<const Dependency*> way(
      const std::vector<std::vector<const Dependency*>>& from, std::size_t start, std::size_t end)
  {
    std::vector<const Dependency*> reached_by(from.size(), nullptr);
    std::vector<std::size_t> reached = {start};
    for (std::size_t next = 0; next < reached.size() && reached_by[end] == nullptr; ++next)
    {
      for (const Dependency* dependency : from[reached[next]])
      {
        if (reached_by[dependency->needed] == nullptr && dependency->needed != start)
        {
          reached_by[dependency->needed] = dependency;
          reached.push_back(dependency->needed);
        }
      }
    }
    std::vector<const Dependency*> path;
    for (std::size_t at = end; at != start; at = path.back()->head)
    {
      path.push_back(reached_by[at]);
    }
    std::reverse(path.begin(), path.end());
    return path;
  }

  void reportShortestCycle(const Graph& graph)
  {
    const Components components = graph.components();
    std::vector<std::vector<const Dependency*>> from(graph.nodes.size());
    for (const Dependency& dependency : graph.dependencies)
    {
      from[dependency.head].push_back(&dependency);
    }
    constexpr std::size_t kMaxLooks = 100;  // a cycle that is short enough to read is found sooner
    std::vector<const Dependency*> shortest;
    std::size_t looks = 0;
    for (const Dependency& negative : graph.dependencies)
    {
      if (!negative.negated || looks == kMaxLooks ||
          !components.together(negative.head, negative.needed))
      {
        continue;
      }
      ++looks;
      std::vector<const Dependency*> cycle = {&negative};
      const auto back = way(from, negative.needed, negative.head);
      cycle.insert(cycle.end(), back.begin(), back.end());
      if (shortest.empty() || cycle.size() < shortest.size())
      {
        shortest = std::move(cycle);
      }
    }
    if (!shortest.empty())
    {
      report(graph, shortest);
    }
  }

  /// At the first rule of the cycle in the text, naming all from there on.
  void report(const Graph& graph, std::vector<const Dependency*> cycle)
  {
    const auto placeOfRule = [&](const Dependency* dependency) -> const SourcePosition& {
      return description_.constraints[dependency->rule].position;
    };
    const auto first =
        std::min_element(cycle.begin(), cycle.end(), [&](const Dependency* a, const Dependency* b) {
          const SourcePosition& one = placeOfRule(a);
          const SourcePosition& other = placeOfRule(b);
          return std::tie(one.line, one.column) < std::tie(other.line, other.column);
        });
    std::rotate(cycle.begin(), first, cycle.end());
    std::vector<std::string> needs;
    for (const Dependency* dependency : cycle)
    {
      needs.push_back(graph.nodes[dependency->head] + " needs " + (dependency->negated ? "-" : "") +
                      graph.nodes[dependency->needed] + " (" + placeOf(placeOfRule(dependency)) +
                      ")");
    }
    problems_.push_back({placeOfRule(cycle.front()),
                         "the definition of " + graph.nodes[cycle.front()->head] +
                             " rests on its own negation, expected definitions without such a "
                             "cycle: " +
                             listed(needs)});
  }

  const Description& description_;
  Encoding encoding_;
  std::vector<Diagnostic>& problems_;
  Graph names_;
  std::map<std::string, std::size_t> name_index_;
};

}  // namespace

void checkDefinitions(const Description& description, std::vector<Diagnostic>& problems)
{
  DefinitionChecker(description, problems).run();
}

}  // namespace kr3::reasoner
