#include "sparc_syntax.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "sparc_tokens.hpp"
#include "text.hpp"

namespace kr3::reasoner::sparc
{

namespace
{

/// What stops a statement from being parsed.
struct Refusal
{
  Token at;
  std::string expected;
};

class Parser
{
public:
  Parser(const std::string& text, std::string file, std::vector<Diagnostic>& problems)
    : file_(std::move(file)), tokens_(tokensOf(text)), problems_(problems)
  {
  }

  Program run()
  {
    std::string section;
    while (!peek().text.empty())
    {
      const std::string& word = peek().text;
      if (word == "sorts" || word == "predicates" || word == "rules" || word == "display")
      {
        section = word;
        ++at_;
        continue;
      }
      try
      {
        statement(section);
      }
      catch (const Refusal& refusal)
      {
        problems_.push_back(
            {{file_, refusal.at.line, refusal.at.column},
             "found " + (refusal.at.text.empty() ? "the end" : "'" + refusal.at.text + "'") +
                 ", expected " + refusal.expected});
        while (!peek().text.empty() && peek().text != ".")
        {
          ++at_;
        }
        at_ += peek().text == "." ? 1 : 0;
      }
    }
    return std::move(program_);
  }

private:
  [[nodiscard]] const Token& peek(std::size_t ahead = 0) const
  {
    return tokens_[std::min(at_ + ahead, tokens_.size() - 1)];
  }

  bool accept(const std::string& text)
  {
    const bool is_there = peek().text == text;
    at_ += is_there ? 1 : 0;
    return is_there;
  }

  void expect(const std::string& text)
  {
    if (!accept(text))
    {
      throw Refusal{peek(), "'" + text + "'"};
    }
  }

  std::string word(const std::string& what)
  {
    if (!peek().isWord())
    {
      throw Refusal{peek(), what};
    }
    return tokens_[at_++].text;
  }

  std::string sortName()
  {
    if (peek().text.size() < 2 || peek().text[0] != '#')
    {
      throw Refusal{peek(), "a sort, as #name"};
    }
    return tokens_[at_++].text.substr(1);
  }

  void statement(const std::string& section)
  {
    if (peek().text == "#const")
    {
      ++at_;
      const std::string name = word("a name");
      expect("=");
      constants_[name] = word("a number");
      expect(".");
    }
    else if (peek().text == "#maxint")
    {
      skipStatement();  // KR3 has no bound on numbers to be told
    }
    else if (section == "sorts")
    {
      sort();
    }
    else if (section == "predicates")
    {
      predicate();
    }
    else if (section == "rules")
    {
      rule();
    }
    else if (section == "display")
    {
      skipStatement();
    }
    else
    {
      throw Refusal{peek(), "'sorts', 'predicates' or 'rules'"};
    }
  }

  void skipStatement()
  {
    while (!peek().text.empty() && !accept("."))
    {
      ++at_;
    }
  }

  std::string constant(const std::string& what)
  {
    const std::string text = word(what);
    const auto found = constants_.find(text);
    return found == constants_.end() ? text : found->second;
  }

  long number()
  {
    const bool negative = accept("-");
    const Token token = peek();
    const std::string text = constant("a number");
    if (text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos)
    {
      throw Refusal{token, "a number of at most 9 digits"};
    }
    return negative ? -std::stol(text) : std::stol(text);
  }

  std::vector<std::string> range(const std::string& prefix)
  {
    const Token token = peek();
    const long first = number();
    expect("..");
    const long last = number();
    if (last < first || last - first >= 100000)
    {
      throw Refusal{token, "a range of 1 to 100000 numbers"};
    }
    std::vector<std::string> elements;
    for (long i = first; i <= last; ++i)
    {
      elements.push_back(prefix + std::to_string(i));
    }
    return elements;
  }

  SortPart sortPart()
  {
    SortPart part;
    if (accept("{"))
    {
      do
      {
        part.elements.push_back(constant("a constant"));
      } while (accept(","));
      expect("}");
    }
    else if (accept("["))
    {
      const std::string prefix = word("a prefix");
      expect("]");
      expect("[");
      part.elements = range(prefix);
      expect("]");
    }
    else if (peek().text[0] == '#')
    {
      part.sort = sortName();
    }
    else if (peek(1).text == "..")
    {
      part.elements = range("");
    }
    else
    {
      function(part);
    }
    return part;
  }

  void function(SortPart& part)
  {
    part.function.name = word("a set, a range, a sort or a function of sorts");
    if (accept("("))
    {
      do
      {
        part.function.arguments.push_back({sortName(), {}, false});
        if (accept("("))
        {
          part.variables.push_back({word("a variable"), {}, true});
          expect(")");
        }
      } while (accept(","));
      expect(")");
    }
    if (accept(":"))
    {
      do
      {
        part.conditions.push_back(literal());
      } while (accept(","));
    }
  }

  void sort()
  {
    Sort sort;
    sort.position = {file_, peek().line, peek().column};
    sort.name = sortName();
    expect("=");
    do
    {
      sort.parts.push_back(sortPart());
    } while (accept("+"));
    expect(".");
    program_.sorts.push_back(std::move(sort));
  }

  void predicate()
  {
    Predicate predicate;
    predicate.position = {file_, peek().line, peek().column};
    predicate.name = word("a predicate");
    if (accept("(") && !accept(")"))
    {
      do
      {
        predicate.sorts.push_back(sortName());
      } while (accept(","));
      expect(")");
    }
    expect(".");
    program_.predicates.push_back(std::move(predicate));
  }

  Term term(int depth = 0)
  {
    constexpr int kMaxDepth = 20;
    Term result;
    if (depth > kMaxDepth)
    {
      throw Refusal{peek(), "a term that is nested less"};
    }
    const bool negative = accept("-");
    result.name = (negative ? "-" : "") + constant("a term");
    result.is_variable = std::isupper(static_cast<unsigned char>(result.name[0])) != 0;
    if (!result.is_variable && accept("(") && !accept(")"))
    {
      do
      {
        result.arguments.push_back(term(depth + 1));
      } while (accept(","));
      expect(")");
    }
    for (const char* sign : {"+", "-"})
    {
      if (accept(sign))
      {
        Term right = term(depth + 1);
        return {sign, {std::move(result), std::move(right)}, false};
      }
    }
    return result;
  }

  Literal literal()
  {
    static const std::set<std::string> kAggregates = {"#count", "#sum", "#min", "#max"};
    if (kAggregates.count(peek().text) > 0)
    {
      throw Refusal{peek(), "an atom or a comparison: aggregates are not in the subset"};
    }
    Literal result;
    result.is_default_negated = accept("not");
    result.is_negative = accept("-");
    result.atom = term();
    for (const char* relation : {"=", "!=", "<=", ">=", "<", ">"})
    {
      if (accept(relation))
      {
        result.relation = relation;
        result.right = term();
        break;
      }
    }
    return result;
  }

  /// `1 {occurs(A, I) : #action(A)} 1`
  void choice(Rule& rule)
  {
    rule.is_choice = true;
    at_ += peek().text == "{" ? 0 : 1;
    expect("{");
    while (peek().text != "}")
    {
      rule.head.push_back(literal());
      while (!peek().text.empty() && peek().text != ";" && peek().text != "}")
      {
        ++at_;
      }
      if (!accept(";") && peek().text != "}")
      {
        throw Refusal{peek(), "'}'"};
      }
    }
    expect("}");
    at_ += peek().isWord() ? 1 : 0;
  }

  void rule()
  {
    Rule rule;
    rule.position = {file_, peek().line, peek().column};
    static const std::set<std::string> kPreferences = {":~", "#minimize", "#maximize"};
    if (kPreferences.count(peek().text) > 0)
    {
      throw Refusal{peek(), "a rule: KR3 minimizes explanations and plans itself (see cost)"};
    }
    if (peek().text == "{" || (peek().isWord() && peek(1).text == "{"))
    {
      choice(rule);
    }
    else if (peek().text != ":-")
    {
      do
      {
        rule.head.push_back(literal());
      } while (accept("|"));
    }
    rule.restores_consistency = peek().text == ":+";
    if ((accept(":-") || accept(":+")) && peek().text != ".")
    {
      do
      {
        rule.body.push_back(literal());
      } while (accept(","));
    }
    expect(".");
    program_.rules.push_back(std::move(rule));
  }

  std::string file_;
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::vector<Diagnostic>& problems_;
  std::map<std::string, std::string> constants_;
  Program program_;
};

}  // namespace

Program parse(const std::string& text, const std::string& file, std::vector<Diagnostic>& problems)
{
  checkBytes(text, file, problems);
  return Parser(text, file, problems).run();
}

}  // namespace kr3::reasoner::sparc
