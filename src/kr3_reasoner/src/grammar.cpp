#include "grammar.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <tao/pegtl.hpp>
#include <tao/pegtl/contrib/parse_tree.hpp>

#include "grammar_rules.hpp"
#include "text.hpp"

namespace kr3::reasoner::grammar
{

namespace
{

/// What PEGTL builds: a node per selected rule.
struct Tree
{
  std::vector<std::unique_ptr<Tree>> children;
  Rule rule = Rule::kNone;
  const char* begin = nullptr;
  const char* end = nullptr;
  int line = 0;
  int column = 0;

  template <typename Matched, typename Input, typename... States>
  void start(const Input& in, States&&... /*states*/)
  {
    rule = kRuleOf<Matched>;
    begin = in.current();
    line = static_cast<int>(in.iterator().line);
    column = static_cast<int>(in.iterator().column);
  }

  template <typename Matched, typename Input, typename... States>
  void success(const Input& in, States&&... /*states*/)
  {
    end = in.current();
  }

  template <typename Matched, typename Input, typename... States>
  void failure(const Input& /*in*/, States&&... /*states*/)
  {
  }

  template <typename... States>
  void emplace_back(std::unique_ptr<Tree>&& child, States&&... /*states*/)
  {
    children.push_back(std::move(child));
  }
};

template <typename Matched>
using Selector = std::bool_constant<kRuleOf<Matched> != Rule::kNone>;

constexpr std::size_t kMaxTried = 200;  // repetitions included

/// How far parsing reached, and the tokens that were tried there.
struct Progress
{
  const char* furthest = nullptr;
  int line = 0;
  int column = 0;
  std::vector<const char*> expected;  // names of tokens, with repetitions
  int depth = 0;
};

struct TooDeep
{
  int line;
  int column;
};

template <typename Matched>
constexpr bool kNests = std::is_same_v<Matched, Disjunction> || std::is_same_v<Matched, Negation>;

template <typename Matched>
struct Control : pegtl::normal<Matched>
{
  template <typename Input>
  static void start(const Input& in, Progress& progress)
  {
    if constexpr (kTokenName<Matched> != nullptr)
    {
      if (progress.furthest == nullptr || in.current() > progress.furthest)
      {
        progress.furthest = in.current();
        progress.line = static_cast<int>(in.iterator().line);
        progress.column = static_cast<int>(in.iterator().column);
        progress.expected.clear();
      }
      if (in.current() == progress.furthest && progress.expected.size() < kMaxTried)
      {
        progress.expected.push_back(kTokenName<Matched>);
      }
    }
    if constexpr (kNests<Matched>)
    {
      if (++progress.depth > kMaxDepth)
      {
        throw TooDeep{static_cast<int>(in.iterator().line), static_cast<int>(in.iterator().column)};
      }
    }
  }

  template <typename Input>
  static void success(const Input& /*in*/, Progress& progress)
  {
    progress.depth -= kNests<Matched> ? 1 : 0;
  }

  template <typename Input>
  static void failure(const Input& /*in*/, Progress& progress)
  {
    progress.depth -= kNests<Matched> ? 1 : 0;
  }
};

std::string expectedOf(const std::vector<const char*>& tried)
{
  const std::set<std::string_view> tokens(tried.begin(), tried.end());
  std::vector<std::string_view> expected;
  for (std::string_view names : tokens)  // a token may stand for several: "'<', '<=' or '>='"
  {
    while (!names.empty())
    {
      const std::size_t end = std::min(names.find(", "), names.find(" or "));
      const std::string_view name = names.substr(0, end);
      if (std::find(expected.begin(), expected.end(), name) == expected.end())
      {
        expected.push_back(name);
      }
      names.remove_prefix(end == std::string_view::npos ? names.size()
                                                        : end + (names[end] == ',' ? 2 : 4));
    }
  }
  std::string text;
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    text += i == 0 ? "" : i + 1 == expected.size() ? " or " : ", ";
    text += expected[i];
  }
  return text;
}

Node convert(const Tree& tree, const std::string& file, std::vector<Diagnostic>& problems)
{
  Node node;
  node.rule = tree.rule;
  node.text = std::string_view(tree.begin, static_cast<std::size_t>(tree.end - tree.begin));
  node.line = tree.line;
  node.column = tree.column;
  if ((node.rule == Rule::kName || node.rule == Rule::kVariable) && node.text.size() > kMaxName)
  {
    problems.push_back({{file, node.line, node.column},
                        "found a name of " + std::to_string(node.text.size()) +
                            " characters, expected at most " + std::to_string(kMaxName)});
  }
  node.children.reserve(tree.children.size());
  for (const auto& child : tree.children)
  {
    node.children.push_back(convert(*child, file, problems));
  }
  return node;
}

template <typename Entry>
Node parseAs(std::string_view text, const SourcePosition& start, std::vector<Diagnostic>& problems)
{
  pegtl::memory_input<pegtl::tracking_mode::eager, pegtl::eol::lf_crlf, const char*> in(
      text.data(), text.data() + text.size(), "", 0, static_cast<std::size_t>(start.line),
      static_cast<std::size_t>(start.column));
  Progress progress;
  try
  {
    const auto tree =
        pegtl::parse_tree::parse<Entry, Tree, Selector, pegtl::nothing, Control>(in, progress);
    if (tree)
    {
      const std::size_t before = problems.size();
      Node node = convert(*tree->children.front(), start.file, problems);
      return problems.size() == before ? std::move(node) : Node{};
    }
  }
  catch (const TooDeep& place)
  {
    problems.push_back({{start.file, place.line, place.column},
                        "found a formula nested deeper than " + std::to_string(kMaxDepth) +
                            ", expected fewer parentheses and negations around each other"});
    return {};
  }
  const char* end = text.data() + text.size();
  const char* at = progress.furthest == nullptr ? end : progress.furthest;
  problems.push_back({{start.file, progress.line, progress.column},
                      "found " +
                          quotedWord(std::string_view(at, static_cast<std::size_t>(end - at))) +
                          ", expected " + expectedOf(progress.expected)});
  return {};
}

}  // namespace

const Node* Node::child(Rule wanted) const
{
  for (const Node& node : children)
  {
    if (node.rule == wanted)
    {
      return &node;
    }
  }
  return nullptr;
}

Node parse(Kind kind, std::string_view text, const SourcePosition& start,
           std::vector<Diagnostic>& problems)
{
  switch (kind)
  {
    case Kind::kSort:
      return parseAs<Statement<SortDeclaration>>(text, start, problems);
    case Kind::kStatic:
      return parseAs<Statement<StaticDeclarationRule>>(text, start, problems);
    case Kind::kFluent:
      return parseAs<Statement<FluentDeclarationRule>>(text, start, problems);
    case Kind::kAction:
      return parseAs<Statement<ActionDeclarationRule>>(text, start, problems);
    case Kind::kAxiom:
      return parseAs<Statement<Axiom>>(text, start, problems);
    case Kind::kObservation:
      return parseAs<Statement<ObservationLawRule>>(text, start, problems);
    case Kind::kDefault:
      return parseAs<Statement<DefaultRule>>(text, start, problems);
    case Kind::kFact:
      return parseAs<Statement<Fact>>(text, start, problems);
    case Kind::kRecord:
      return parseAs<pegtl::seq<Spaces, RecordRule>>(text, start, problems);
    case Kind::kGroundLiteral:
      return parseAs<Phrase<Condition>>(text, start, problems);
    case Kind::kGroundAction:
      return parseAs<Phrase<Atom>>(text, start, problems);
    case Kind::kGoal:
      return parseAs<Phrase<Disjunction>>(text, start, problems);
  }
  return {};
}

}  // namespace kr3::reasoner::grammar
