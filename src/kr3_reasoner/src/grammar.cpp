#include "grammar.hpp"

#include <cctype>
#include <set>
#include <string_view>
#include <utility>

#include <tao/pegtl.hpp>
#include <tao/pegtl/contrib/parse_tree.hpp>

namespace kr3::reasoner::grammar
{

namespace
{

namespace pegtl = tao::pegtl;

// ---- Characters and words
// -------------------------------------------------------------------------------------------

struct Comment : pegtl::seq<pegtl::one<'%'>, pegtl::until<pegtl::at<pegtl::eolf>>>
{
};
struct Spaces : pegtl::star<pegtl::sor<pegtl::space, Comment>>
{
};
struct WordRest : pegtl::star<pegtl::sor<pegtl::alnum, pegtl::one<'_'>>>
{
};
struct WordEnd : pegtl::not_at<pegtl::sor<pegtl::alnum, pegtl::one<'_'>>>
{
};
template <typename Word>
struct Whole : pegtl::seq<Word, WordEnd>
{
};

struct IfWord : Whole<TAO_PEGTL_STRING("if")>
{
};
struct NotWord : Whole<TAO_PEGTL_STRING("not")>
{
};
struct OrWord : Whole<TAO_PEGTL_STRING("or")>
{
};
struct AndWord : Whole<TAO_PEGTL_STRING("and")>
{
};
struct CausesWord : Whole<TAO_PEGTL_STRING("causes")>
{
};
struct ObservesWord : Whole<TAO_PEGTL_STRING("observes")>
{
};
struct ImpossibleWord : Whole<TAO_PEGTL_STRING("impossible")>
{
};
struct NothingWord : Whole<TAO_PEGTL_STRING("nothing")>
{
};
struct Reserved : pegtl::sor<IfWord, NotWord, OrWord, AndWord, CausesWord, ObservesWord,
                             ImpossibleWord, NothingWord>
{
};

struct Name : pegtl::seq<pegtl::not_at<Reserved>, pegtl::lower, WordRest>
{
};
struct Variable : pegtl::seq<pegtl::upper, WordRest>
{
};
struct Number : pegtl::seq<pegtl::opt<pegtl::one<'-'>>, pegtl::plus<pegtl::digit>, WordEnd>
{
};
struct Decimal
  : pegtl::seq<pegtl::plus<pegtl::digit>, pegtl::opt<pegtl::one<'.'>, pegtl::plus<pegtl::digit>>>
{
};
struct Relation : pegtl::sor<TAO_PEGTL_STRING("!="), TAO_PEGTL_STRING("<="), TAO_PEGTL_STRING(">="),
                             pegtl::one<'=', '<', '>'>>
{
};
struct Minus : pegtl::one<'-'>
{
};
struct FalseWord : Whole<TAO_PEGTL_STRING("false")>
{
};

// ---- Tokens: a word or sign, and the spaces after it. The errors name tokens.
// --------------------------------------

template <typename Content>
struct Token : pegtl::seq<Content, Spaces>
{
};
template <char kSign>
struct Sign : Token<pegtl::one<kSign>>
{
};
struct NameToken : Token<Name>
{
};
struct VariableToken : Token<Variable>
{
};
struct NumberToken : Token<Number>
{
};
struct DecimalToken : Token<Decimal>
{
};
struct RelationToken : Token<Relation>
{
};
struct EqualToken : Token<pegtl::one<'='>>
{
};
struct RangeToken : Token<pegtl::two<'.'>>
{
};
struct DotToken : Token<pegtl::seq<pegtl::one<'.'>, pegtl::not_at<pegtl::one<'.'>>>>
{
};
struct MinusToken : Token<Minus>
{
};
struct IfToken : Token<IfWord>
{
};
struct NotToken : Token<NotWord>
{
};
struct OrToken : Token<OrWord>
{
};
struct AndToken : Token<AndWord>
{
};
struct CausesToken : Token<CausesWord>
{
};
struct ObservesToken : Token<ObservesWord>
{
};
struct ImpossibleToken : Token<ImpossibleWord>
{
};
struct NothingToken : Token<NothingWord>
{
};
struct FalseToken : Token<FalseWord>
{
};
struct IntoToken : Token<Whole<TAO_PEGTL_STRING("into")>>
{
};
struct ByToken : Token<Whole<TAO_PEGTL_STRING("by")>>
{
};
struct OverToken : Token<Whole<TAO_PEGTL_STRING("over")>>
{
};
struct EndToken : pegtl::eof
{
};

// What an error calls a token; nullptr for rules that are no tokens.
template <typename>
constexpr const char* kTokenName = nullptr;
template <char kSign>
constexpr char kSignName[] = {'\'', kSign, '\'', '\0'};
template <char kSign>
constexpr const char* kTokenName<Sign<kSign>> = kSignName<kSign>;
template <>
constexpr const char* kTokenName<Name> = "a name";
template <>
constexpr const char* kTokenName<Variable> = "a variable";
template <>
constexpr const char* kTokenName<Number> = "a number";
template <>
constexpr const char* kTokenName<Decimal> = "a number";
template <>
constexpr const char* kTokenName<Relation> = "'=', '!=', '<', '<=', '>' or '>='";
template <>
constexpr const char* kTokenName<EqualToken> = "'='";
template <>
constexpr const char* kTokenName<RangeToken> = "'..'";
template <>
constexpr const char* kTokenName<DotToken> = "'.'";
template <>
constexpr const char* kTokenName<Minus> = "'-'";
template <>
constexpr const char* kTokenName<IfToken> = "'if'";
template <>
constexpr const char* kTokenName<NotToken> = "'not'";
template <>
constexpr const char* kTokenName<OrToken> = "'or'";
template <>
constexpr const char* kTokenName<AndToken> = "'and'";
template <>
constexpr const char* kTokenName<CausesToken> = "'causes'";
template <>
constexpr const char* kTokenName<ObservesToken> = "'observes'";
template <>
constexpr const char* kTokenName<ImpossibleToken> = "'impossible'";
template <>
constexpr const char* kTokenName<NothingToken> = "'nothing'";
template <>
constexpr const char* kTokenName<IntoToken> = "'into'";
template <>
constexpr const char* kTokenName<ByToken> = "'by'";
template <>
constexpr const char* kTokenName<OverToken> = "'over'";
template <>
constexpr const char* kTokenName<EndToken> = "the end";

// ---- Formulas
// -------------------------------------------------------------------------------------------------------

template <typename Item>
struct ListOf : pegtl::list<Item, Sign<','>>
{
};
template <typename Content>
struct InParentheses : pegtl::seq<Sign<'('>, Content, Sign<')'>>
{
};

struct Term : pegtl::sor<NameToken, VariableToken, NumberToken>
{
};
struct Arguments : InParentheses<ListOf<Term>>
{
};
struct Atom : pegtl::seq<NameToken, pegtl::opt<Arguments>>
{
};
struct Comparable : pegtl::seq<pegtl::sor<VariableToken, NumberToken>, RelationToken, Term>
{
};
struct Condition : pegtl::sor<pegtl::seq<NotToken, Atom>, Comparable, pegtl::seq<MinusToken, Atom>,
                              pegtl::seq<Atom, pegtl::opt<RelationToken, Term>>>
{
};
struct Body : ListOf<Condition>
{
};
struct OptionalBody : pegtl::opt<IfToken, Body>
{
};
struct Label : pegtl::seq<Sign<'['>, NameToken, Sign<']'>>
{
};

// ---- Statements
// -----------------------------------------------------------------------------------------------------

struct Set
  : pegtl::seq<Sign<'{'>, pegtl::opt<ListOf<pegtl::sor<NameToken, NumberToken>>>, Sign<'}'>>
{
};
struct Range : pegtl::seq<NumberToken, RangeToken, NumberToken>
{
};
struct SortName : NameToken
{
};
struct SortDeclaration
  : pegtl::seq<NameToken, EqualToken, pegtl::list<pegtl::sor<Set, Range, SortName>, Sign<'+'>>>
{
};

struct Parameters : InParentheses<ListOf<SortName>>
{
};
struct ValueSort : pegtl::seq<Sign<':'>, SortName>
{
};
struct Signature : pegtl::seq<NameToken, pegtl::opt<Parameters>>
{
};
struct FluentKindWord : Whole<pegtl::sor<TAO_PEGTL_STRING("inertial"), TAO_PEGTL_STRING("defined"),
                                         TAO_PEGTL_STRING("knowledge")>>
{
};
struct FluentKindToken : Token<FluentKindWord>
{
};
template <>
constexpr const char* kTokenName<FluentKindWord> = "'inertial', 'defined' or 'knowledge'";
struct FluentDeclaration : pegtl::seq<FluentKindToken, Signature, pegtl::opt<ValueSort>>
{
};
struct StaticDeclaration : pegtl::seq<Signature, pegtl::opt<ValueSort>>
{
};
struct ExogenousWord : Whole<TAO_PEGTL_STRING("exogenous")>
{
};
struct ActionDeclaration : pegtl::seq<pegtl::opt<Token<ExogenousWord>>, Signature>
{
};

struct Choice : pegtl::seq<Sign<'{'>, VariableToken, Sign<':'>, Body, Sign<'}'>>
{
};
struct Effect : pegtl::sor<pegtl::seq<MinusToken, Atom>,
                           pegtl::seq<Atom, pegtl::opt<EqualToken, pegtl::sor<Choice, Term>>>>
{
};
struct Outcome : pegtl::seq<pegtl::sor<NothingToken, ListOf<Effect>>, pegtl::opt<Label>>
{
};
struct CausalLaw : pegtl::seq<Atom, CausesToken, pegtl::list<Outcome, OrToken>, OptionalBody>
{
};
struct Impossible
  : pegtl::seq<ImpossibleToken, ListOf<pegtl::sor<VariableToken, Atom>>, OptionalBody>
{
};
struct Constraint
  : pegtl::sor<pegtl::seq<FalseToken, IfToken, Body>, pegtl::seq<Condition, OptionalBody>>
{
};
struct Axiom : pegtl::sor<Impossible, CausalLaw, Constraint>
{
};
struct ObservationLaw : pegtl::seq<Atom, ObservesToken, Atom, pegtl::opt<EqualToken, Term>>
{
};
struct DefaultRule : pegtl::seq<pegtl::opt<Token<Whole<TAO_PEGTL_STRING("default")>>>, Atom,
                                Sign<':'>, Condition, OptionalBody>
{
};
struct Fact : Condition
{
};
struct Magnification : pegtl::seq<Token<Whole<TAO_PEGTL_STRING("magnify")>>, SortName, IntoToken,
                                  SortName, ByToken, NameToken>
{
};
struct Preference : pegtl::seq<Token<Whole<TAO_PEGTL_STRING("prefer")>>, Atom, OverToken, Atom>
{
};
struct Cost
  : pegtl::seq<Token<Whole<TAO_PEGTL_STRING("cost")>>, Atom, EqualToken, DecimalToken, OptionalBody>
{
};

template <typename Specific>
struct Statement
  : pegtl::seq<Spaces,
               pegtl::sor<pegtl::seq<pegtl::sor<Magnification, Preference, Cost>, DotToken>,
                          pegtl::seq<Specific, DotToken>>,
               pegtl::eof>
{
};
template <typename Specific>
struct Phrase : pegtl::seq<Spaces, Specific, EndToken>
{
};

// ---- Histories and goals
// --------------------------------------------------------------------------------------------

struct RecordKindWord : Whole<pegtl::sor<TAO_PEGTL_STRING("obs"), TAO_PEGTL_STRING("hpd"),
                                         TAO_PEGTL_STRING("attempt"), TAO_PEGTL_STRING("init")>>
{
};
struct RecordKindToken : Token<RecordKindWord>
{
};
template <>
constexpr const char* kTokenName<RecordKindWord> = "'obs', 'hpd', 'attempt' or 'init'";
struct Record
  : pegtl::seq<RecordKindToken, InParentheses<pegtl::seq<Condition, pegtl::star<Sign<','>, Term>>>,
               pegtl::opt<Sign<'['>, DecimalToken, Sign<']'>>>
{
};

struct Disjunction;
struct Negation;
struct Unit : pegtl::sor<InParentheses<Disjunction>, Negation, Condition>
{
};
struct Negation : pegtl::seq<NotToken, Unit>
{
};
struct Conjunction : pegtl::list<Unit, pegtl::sor<AndToken, Sign<','>>>
{
};
struct Disjunction : pegtl::list<Conjunction, OrToken>
{
};

// ---- Trees
// ----------------------------------------------------------------------------------------------------------

template <typename R>
using Selector = pegtl::parse_tree::selector<
    R, pegtl::parse_tree::store_content::on<
           SortDeclaration, Set, Range, SortName, FluentDeclaration, StaticDeclaration,
           FluentKindWord, ActionDeclaration, ExogenousWord, Parameters, ValueSort, CausalLaw,
           Outcome, NothingWord, Label, Effect, Choice, Impossible, Constraint, FalseToken, Body,
           ObservationLaw, DefaultRule, Fact, Magnification, Preference, Cost, Decimal, Atom,
           Arguments, Name, Variable, Number, NotToken, Minus, Relation, Condition, Record,
           RecordKindWord, Disjunction, Conjunction, Negation>>;

struct Named
{
  std::string_view type;
  Rule rule;
};

template <typename R>
Named named(Rule rule)
{
  return {pegtl::demangle<R>(), rule};
}

Rule ruleOf(const pegtl::parse_tree::node& node)
{
  static const std::vector<Named> kRules = {named<Name>(Rule::kName),
                                            named<Atom>(Rule::kAtom),
                                            named<Arguments>(Rule::kArguments),
                                            named<Variable>(Rule::kVariable),
                                            named<Number>(Rule::kNumber),
                                            named<NotToken>(Rule::kNot),
                                            named<Minus>(Rule::kMinus),
                                            named<Relation>(Rule::kRelation),
                                            named<Condition>(Rule::kCondition),
                                            named<Body>(Rule::kBody),
                                            named<SortDeclaration>(Rule::kSortDeclaration),
                                            named<Set>(Rule::kSet),
                                            named<Range>(Rule::kRange),
                                            named<SortName>(Rule::kSortName),
                                            named<FluentDeclaration>(Rule::kFluentDeclaration),
                                            named<StaticDeclaration>(Rule::kFluentDeclaration),
                                            named<FluentKindWord>(Rule::kFluentKind),
                                            named<ActionDeclaration>(Rule::kActionDeclaration),
                                            named<ExogenousWord>(Rule::kExogenous),
                                            named<Parameters>(Rule::kParameters),
                                            named<ValueSort>(Rule::kValueSort),
                                            named<CausalLaw>(Rule::kCausalLaw),
                                            named<Outcome>(Rule::kOutcome),
                                            named<NothingWord>(Rule::kNothing),
                                            named<Label>(Rule::kLabel),
                                            named<Effect>(Rule::kEffect),
                                            named<Choice>(Rule::kChoice),
                                            named<Impossible>(Rule::kImpossible),
                                            named<Constraint>(Rule::kConstraint),
                                            named<FalseToken>(Rule::kFalse),
                                            named<ObservationLaw>(Rule::kObservationLaw),
                                            named<DefaultRule>(Rule::kDefault),
                                            named<Fact>(Rule::kFact),
                                            named<Magnification>(Rule::kMagnification),
                                            named<Preference>(Rule::kPreference),
                                            named<Cost>(Rule::kCost),
                                            named<Decimal>(Rule::kDecimal),
                                            named<Record>(Rule::kRecord),
                                            named<RecordKindWord>(Rule::kRecordKind),
                                            named<Disjunction>(Rule::kDisjunction),
                                            named<Conjunction>(Rule::kConjunction),
                                            named<Negation>(Rule::kNegation)};
  for (const Named& known : kRules)
  {
    if (known.type == node.type)
    {
      return known.rule;
    }
  }
  return Rule::kNone;
}

Node convert(const pegtl::parse_tree::node& tree, const std::string& file)
{
  Node node;
  if (!tree.is_root())
  {
    node.rule = ruleOf(tree);
    node.text = tree.has_content() ? tree.string() : "";
    node.position = {file, static_cast<int>(tree.m_begin.line),
                     static_cast<int>(tree.m_begin.column)};
  }
  for (const auto& child : tree.children)
  {
    node.children.push_back(convert(*child, file));
  }
  return node;
}

// ---- Errors: the furthest place that parsing reached, and the tokens tried there
// ------------------------------------

struct Furthest
{
  const char* at = nullptr;
  SourcePosition position;
  std::set<std::string> expected;
};

template <typename R>
struct Control : pegtl::normal<R>
{
  template <typename Input>
  static void start(const Input& in, Furthest& furthest)
  {
    if constexpr (kTokenName<R> != nullptr)
    {
      if (furthest.at == nullptr || in.current() > furthest.at)
      {
        furthest.at = in.current();
        furthest.position.line = static_cast<int>(in.position().line);
        furthest.position.column = static_cast<int>(in.position().column);
        furthest.expected.clear();
      }
      if (in.current() == furthest.at)
      {
        furthest.expected.insert(kTokenName<R>);
      }
    }
  }
};

std::string found(const char* begin, const char* end)
{
  if (begin == nullptr || begin == end)
  {
    return "the end";
  }
  const auto in_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  const char* last = begin + 1;
  while (in_word(*begin) && last != end && in_word(*last))
  {
    ++last;
  }
  return "'" + std::string(begin, last) + "'";
}

std::string expectedOf(const std::set<std::string>& expected)
{
  std::string text;
  std::size_t index = 0;
  for (const std::string& token : expected)
  {
    text += (index == 0 ? "" : index + 1 == expected.size() ? " or " : ", ") + token;
    ++index;
  }
  return text;
}

template <typename Entry>
Node parseAs(const std::string& text, const SourcePosition& start,
             std::vector<Diagnostic>& problems)
{
  pegtl::memory_input<> in(text.data(), text.data() + text.size(), start.file, 0,
                           static_cast<std::size_t>(start.line),
                           static_cast<std::size_t>(start.column));
  Furthest furthest;
  const auto tree =
      pegtl::parse_tree::parse<Entry, pegtl::parse_tree::node, Selector, pegtl::nothing, Control>(
          in, furthest);
  if (tree)
  {
    Node root = convert(*tree, start.file);
    return std::move(root.children.front());
  }
  furthest.position.file = start.file;
  problems.push_back({furthest.position, "found " + found(furthest.at, text.data() + text.size()) +
                                             ", expected " + expectedOf(furthest.expected)});
  return {};
}

// ---- Files
// ----------------------------------------------------------------------------------------------------------

struct SectionWord : Whole<pegtl::sor<TAO_PEGTL_STRING("sorts"), TAO_PEGTL_STRING("statics"),
                                      TAO_PEGTL_STRING("fluents"), TAO_PEGTL_STRING("actions"),
                                      TAO_PEGTL_STRING("axioms"), TAO_PEGTL_STRING("observations"),
                                      TAO_PEGTL_STRING("defaults"), TAO_PEGTL_STRING("facts")>>
{
};
struct LineRest
  : pegtl::seq<pegtl::star<pegtl::blank>, pegtl::at<pegtl::sor<pegtl::eolf, pegtl::one<'%'>>>>
{
};
struct SectionHeader : pegtl::seq<SectionWord, LineRest>
{
};
struct NextSection : pegtl::seq<pegtl::eol, pegtl::star<pegtl::blank>, SectionHeader>
{
};
struct ChunkCharacter
  : pegtl::sor<Comment, pegtl::two<'.'>, pegtl::seq<pegtl::digit, pegtl::one<'.'>, pegtl::digit>,
               pegtl::not_one<'.'>>
{
};
struct ChunkText : pegtl::seq<pegtl::star<pegtl::seq<pegtl::not_at<NextSection>, ChunkCharacter>>,
                              pegtl::opt<pegtl::one<'.'>>>
{
};
struct File : pegtl::until<pegtl::eof, pegtl::sor<pegtl::space, Comment, SectionHeader, ChunkText>>
{
};

struct Splitting
{
  std::string file;
  std::string section;
  std::vector<Chunk> chunks;
};

template <typename R>
struct SplitAction : pegtl::nothing<R>
{
};
template <>
struct SplitAction<SectionHeader>
{
  template <typename Input>
  static void apply(const Input& in, Splitting& splitting)
  {
    const std::string text = in.string();
    splitting.section = text.substr(0, text.find_first_of(" \t"));
  }
};
template <>
struct SplitAction<ChunkText>
{
  template <typename Input>
  static void apply(const Input& in, Splitting& splitting)
  {
    const auto position = in.position();
    splitting.chunks.push_back(
        {splitting.section,
         in.string(),
         {splitting.file, static_cast<int>(position.line), static_cast<int>(position.column)}});
  }
};

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

std::vector<Chunk> split(const std::string& text, const std::string& file)
{
  pegtl::memory_input<> in(text, file);
  Splitting splitting;
  splitting.file = file;
  pegtl::parse<File, SplitAction>(in, splitting);
  return std::move(splitting.chunks);
}

Node parse(Kind kind, const std::string& text, const SourcePosition& start,
           std::vector<Diagnostic>& problems)
{
  switch (kind)
  {
    case Kind::kSort:
      return parseAs<Statement<SortDeclaration>>(text, start, problems);
    case Kind::kStatic:
      return parseAs<Statement<StaticDeclaration>>(text, start, problems);
    case Kind::kFluent:
      return parseAs<Statement<FluentDeclaration>>(text, start, problems);
    case Kind::kAction:
      return parseAs<Statement<ActionDeclaration>>(text, start, problems);
    case Kind::kAxiom:
      return parseAs<Statement<Axiom>>(text, start, problems);
    case Kind::kObservation:
      return parseAs<Statement<ObservationLaw>>(text, start, problems);
    case Kind::kDefault:
      return parseAs<Statement<DefaultRule>>(text, start, problems);
    case Kind::kFact:
      return parseAs<Statement<Fact>>(text, start, problems);
    case Kind::kRecord:
      return parseAs<Statement<Record>>(text, start, problems);
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
