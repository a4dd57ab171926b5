#pragma once

#include <tao/pegtl.hpp>

#include "grammar.hpp"

/// The rules of docs/language.md in PEGTL. Included by grammar.cpp only: one translation unit pays
/// for the templates.
namespace kr3::reasoner::grammar
{

namespace pegtl = tao::pegtl;

// ---- Characters, words, and tokens: a word or sign with the spaces after it. Errors name tokens.

struct Comment : pegtl::seq<pegtl::one<'%'>, pegtl::until<pegtl::at<pegtl::eolf>>>
{
};
struct Spaces : pegtl::star<pegtl::sor<pegtl::space, Comment>>
{
};
struct WordCharacter : pegtl::sor<pegtl::alnum, pegtl::one<'_'>>
{
};
struct WordEnd : pegtl::not_at<WordCharacter>
{
};
template <typename Content>
struct Token : pegtl::seq<Content, Spaces>
{
};
template <typename Text>
struct Word : pegtl::seq<Text, WordEnd>
{
};
template <typename Text>
struct Keyword : Token<Word<Text>>
{
};
template <char kSign>
struct Sign : Token<pegtl::one<kSign>>
{
};

using IfWord = Keyword<TAO_PEGTL_STRING("if")>;
using NotWord = Keyword<TAO_PEGTL_STRING("not")>;
using OrWord = Keyword<TAO_PEGTL_STRING("or")>;
using AndWord = Keyword<TAO_PEGTL_STRING("and")>;
using CausesWord = Keyword<TAO_PEGTL_STRING("causes")>;
using ObservesWord = Keyword<TAO_PEGTL_STRING("observes")>;
using ImpossibleWord = Keyword<TAO_PEGTL_STRING("impossible")>;
using NothingWord = Keyword<TAO_PEGTL_STRING("nothing")>;
using FalseWord = Keyword<TAO_PEGTL_STRING("false")>;
using DefaultWord = Keyword<TAO_PEGTL_STRING("default")>;
using ExogenousWord = Keyword<TAO_PEGTL_STRING("exogenous")>;
using MagnifyWord = Keyword<TAO_PEGTL_STRING("magnify")>;
using IntoWord = Keyword<TAO_PEGTL_STRING("into")>;
using ByWord = Keyword<TAO_PEGTL_STRING("by")>;
using PreferWord = Keyword<TAO_PEGTL_STRING("prefer")>;
using OverWord = Keyword<TAO_PEGTL_STRING("over")>;
using CostWord = Keyword<TAO_PEGTL_STRING("cost")>;
using TotalWord = Keyword<TAO_PEGTL_STRING("total")>;
// The same without a name for errors: they say what a name may not be.
struct Reserved : Word<pegtl::sor<TAO_PEGTL_STRING("if"), TAO_PEGTL_STRING("not"),
                                  TAO_PEGTL_STRING("or"), TAO_PEGTL_STRING("and"),
                                  TAO_PEGTL_STRING("causes"), TAO_PEGTL_STRING("observes"),
                                  TAO_PEGTL_STRING("impossible"), TAO_PEGTL_STRING("nothing")>>
{
};

struct Name : pegtl::seq<pegtl::not_at<Reserved>, pegtl::lower, pegtl::star<WordCharacter>>
{
};
struct Variable : pegtl::seq<pegtl::upper, pegtl::star<WordCharacter>>
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
struct FluentKindWord : Word<pegtl::sor<TAO_PEGTL_STRING("inertial"), TAO_PEGTL_STRING("defined"),
                                        TAO_PEGTL_STRING("knowledge")>>
{
};
struct RecordKindWord : Word<pegtl::sor<TAO_PEGTL_STRING("obs"), TAO_PEGTL_STRING("hpd"),
                                        TAO_PEGTL_STRING("attempt"), TAO_PEGTL_STRING("init")>>
{
};

using NameToken = Token<Name>;
using VariableToken = Token<Variable>;
using NumberToken = Token<Number>;
using DecimalToken = Token<Decimal>;
using RelationToken = Token<Relation>;
using Minus = Sign<'-'>;
struct RangeSign : Token<pegtl::two<'.'>>
{
};
struct Dot : Token<pegtl::seq<pegtl::one<'.'>, pegtl::not_at<pegtl::one<'.'>>>>
{
};
struct End : pegtl::eof
{
};

// What an error calls a token; nullptr for rules that are no tokens.
template <char... kCharacters>
constexpr char kQuoted[] = {'\'', kCharacters..., '\'', '\0'};
template <typename>
constexpr const char* kTokenName = nullptr;
template <char... kCharacters>
constexpr const char* kTokenName<Keyword<pegtl::string<kCharacters...>>> = kQuoted<kCharacters...>;
template <char kSign>
constexpr const char* kTokenName<Sign<kSign>> = kQuoted<kSign>;
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
constexpr const char* kTokenName<FluentKindWord> = "'inertial', 'defined' or 'knowledge'";
template <>
constexpr const char* kTokenName<RecordKindWord> = "'obs', 'hpd', 'attempt' or 'init'";
template <>
constexpr const char* kTokenName<RangeSign> = "'..'";
template <>
constexpr const char* kTokenName<Dot> = "'.'";
template <>
constexpr const char* kTokenName<End> = "the end";

// ---- Parts of statements

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
struct Condition : pegtl::sor<pegtl::seq<NotWord, Atom>, Comparable, pegtl::seq<Minus, Atom>,
                              pegtl::seq<Atom, pegtl::opt<RelationToken, Term>>>
{
};
struct Body : ListOf<Condition>
{
};
struct OptionalBody : pegtl::opt<IfWord, Body>
{
};
struct Label : pegtl::seq<Sign<'['>, NameToken, Sign<']'>>
{
};

// ---- Declarations

struct Set
  : pegtl::seq<Sign<'{'>, pegtl::opt<ListOf<pegtl::sor<NameToken, NumberToken>>>, Sign<'}'>>
{
};
struct Range : pegtl::seq<NumberToken, RangeSign, NumberToken>
{
};
struct SortName : NameToken
{
};
struct SortDeclaration
  : pegtl::seq<NameToken, Sign<'='>, pegtl::list<pegtl::sor<Set, Range, SortName>, Sign<'+'>>>
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
struct FluentDeclarationRule : pegtl::seq<Token<FluentKindWord>, Signature, pegtl::opt<ValueSort>>
{
};
struct StaticDeclarationRule : pegtl::seq<Signature, pegtl::opt<ValueSort>>
{
};
struct ActionDeclarationRule : pegtl::seq<pegtl::opt<ExogenousWord>, Signature>
{
};

// ---- Axioms and the rest

struct Choice : pegtl::seq<Sign<'{'>, VariableToken, Sign<':'>, Body, Sign<'}'>>
{
};
struct EffectRule : pegtl::sor<pegtl::seq<Minus, Atom>,
                               pegtl::seq<Atom, pegtl::opt<Sign<'='>, pegtl::sor<Choice, Term>>>>
{
};
struct OutcomeRule : pegtl::seq<pegtl::sor<NothingWord, ListOf<EffectRule>>, pegtl::opt<Label>>
{
};
struct CausalLawRule : pegtl::seq<Atom, CausesWord, pegtl::list<OutcomeRule, OrWord>, OptionalBody>
{
};
struct Impossible
  : pegtl::seq<ImpossibleWord, ListOf<pegtl::sor<VariableToken, Atom>>, OptionalBody>
{
};
struct Constraint
  : pegtl::sor<pegtl::seq<FalseWord, IfWord, Body>, pegtl::seq<Condition, OptionalBody>>
{
};
struct Axiom : pegtl::sor<Impossible, CausalLawRule, Constraint>
{
};
struct ObservationLawRule : pegtl::seq<Atom, ObservesWord, Atom, pegtl::opt<Sign<'='>, Term>>
{
};
struct DefaultRule : pegtl::seq<pegtl::opt<DefaultWord>, Atom, Sign<':'>, Condition, OptionalBody>
{
};
struct Fact : Condition
{
};
struct MagnificationRule : pegtl::seq<MagnifyWord, SortName, IntoWord, SortName, ByWord, NameToken>
{
};
struct PreferenceRule : pegtl::seq<PreferWord, Atom, OverWord, Atom>
{
};
struct Cost : pegtl::seq<CostWord, Atom, Sign<'='>, DecimalToken, OptionalBody>
{
};
struct Totality : pegtl::seq<TotalWord, NameToken>
{
};
struct Anywhere : pegtl::sor<MagnificationRule, PreferenceRule, Cost, Totality>
{
};

template <typename Specific>
struct Statement
  : pegtl::seq<Spaces, pegtl::sor<pegtl::seq<Anywhere, Dot>, pegtl::seq<Specific, Dot>>, pegtl::eof>
{
};
template <typename Specific>
struct Phrase : pegtl::seq<Spaces, Specific, End>
{
};

// ---- Histories and goals

struct RecordRule : pegtl::seq<Token<RecordKindWord>,
                               InParentheses<pegtl::seq<Condition, pegtl::star<Sign<','>, Term>>>,
                               pegtl::opt<Sign<'['>, DecimalToken, Sign<']'>>, Dot, pegtl::eof>
{
};

struct Disjunction;
struct Negation;
struct Unit : pegtl::sor<InParentheses<Disjunction>, Negation, Condition>
{
};
struct Negation : pegtl::seq<NotWord, Unit>
{
};
struct Conjunction : pegtl::list<Unit, pegtl::sor<AndWord, Sign<','>>>
{
};
struct Disjunction : pegtl::list<Conjunction, OrWord>
{
};

// ---- The rules that become nodes of the tree

template <typename Matched, Rule kNodeRule>
struct Makes
{
};
template <typename... Entries>
struct NodeList
{
};
using Nodes =
    NodeList<Makes<Name, Rule::kName>, Makes<Atom, Rule::kAtom>, Makes<Arguments, Rule::kArguments>,
             Makes<Variable, Rule::kVariable>, Makes<Number, Rule::kNumber>,
             Makes<NotWord, Rule::kNot>, Makes<Minus, Rule::kMinus>,
             Makes<Relation, Rule::kRelation>, Makes<Condition, Rule::kCondition>,
             Makes<Body, Rule::kBody>, Makes<SortDeclaration, Rule::kSortDeclaration>,
             Makes<Set, Rule::kSet>, Makes<Range, Rule::kRange>, Makes<SortName, Rule::kSortName>,
             Makes<FluentDeclarationRule, Rule::kFluentDeclaration>,
             Makes<StaticDeclarationRule, Rule::kFluentDeclaration>,
             Makes<FluentKindWord, Rule::kFluentKind>,
             Makes<ActionDeclarationRule, Rule::kActionDeclaration>,
             Makes<ExogenousWord, Rule::kExogenous>, Makes<Parameters, Rule::kParameters>,
             Makes<ValueSort, Rule::kValueSort>, Makes<CausalLawRule, Rule::kCausalLaw>,
             Makes<OutcomeRule, Rule::kOutcome>, Makes<NothingWord, Rule::kNothing>,
             Makes<Label, Rule::kLabel>, Makes<EffectRule, Rule::kEffect>,
             Makes<Choice, Rule::kChoice>, Makes<Impossible, Rule::kImpossible>,
             Makes<Constraint, Rule::kConstraint>, Makes<FalseWord, Rule::kFalse>,
             Makes<ObservationLawRule, Rule::kObservationLaw>, Makes<DefaultRule, Rule::kDefault>,
             Makes<Fact, Rule::kFact>, Makes<MagnificationRule, Rule::kMagnification>,
             Makes<PreferenceRule, Rule::kPreference>, Makes<Cost, Rule::kCost>,
             Makes<Totality, Rule::kTotality>, Makes<Decimal, Rule::kDecimal>,
             Makes<RecordRule, Rule::kRecord>, Makes<RecordKindWord, Rule::kRecordKind>,
             Makes<Disjunction, Rule::kDisjunction>, Makes<Conjunction, Rule::kConjunction>,
             Makes<Negation, Rule::kNegation>>;

template <typename Matched, typename... Matches, Rule... kRules>
constexpr Rule ruleIn(NodeList<Makes<Matches, kRules>...> /*nodes*/)
{
  Rule found = Rule::kNone;
  ((std::is_same_v<Matched, Matches> ? static_cast<void>(found = kRules) : static_cast<void>(0)),
   ...);
  return found;
}

/// The kind of node that a rule makes; kNone for none.
template <typename Matched>
constexpr Rule kRuleOf = ruleIn<Matched>(Nodes{});

}  // namespace kr3::reasoner::grammar
