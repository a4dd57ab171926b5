#include "history.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include <kr3_common/error.hpp>

#include "builder.hpp"
#include "check.hpp"
#include "grammar.hpp"
#include "ground_phrases.hpp"
#include "text.hpp"
#include "text_file.hpp"

namespace kr3::reasoner
{

namespace
{

using grammar::Node;
using grammar::Rule;

std::string confidenceText(double confidence)
{
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), " [%.6g]", confidence);
  return buffer;
}

RecordKind kindOf(std::string_view word)
{
  return word == "obs"       ? RecordKind::kObserved
         : word == "hpd"     ? RecordKind::kHappened
         : word == "attempt" ? RecordKind::kAttempted
                             : RecordKind::kInitially;
}

/// Reads the records of a history file and checks them, with the places of their parts.
class HistoryReader
{
public:
  /// @param description  must outlive the reader
  HistoryReader(std::string file, const Description& description)
    : file_(std::move(file)), description_(description), symbols_(description)
  {
  }

  std::vector<Record> read(std::string_view text)
  {
    checkBytes(text, file_, problems_);
    for (const Chunk& chunk : split(text))
    {
      const SourcePosition start{file_, chunk.line, chunk.column};
      if (!chunk.section.empty())
      {
        problems_.push_back({start, "found the section " + chunk.section +
                                        ", expected records: a history has no sections"});
        break;
      }
      const Node node = grammar::parse(grammar::Kind::kRecord, chunk.text, start, problems_);
      if (node.rule != Rule::kNone)
      {
        add(node);
      }
    }
    throwIfAny(std::move(problems_));
    return std::move(records_);
  }

private:
  void report(const Node& node, const std::string& message)
  {
    problems_.push_back({{file_, node.line, node.column}, message});
  }

  void add(const Node& node)
  {
    Record record;
    record.position = {file_, node.line, node.column};
    record.kind = kindOf(node.child(Rule::kRecordKind)->text);
    const bool is_action =
        record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
    const bool has_step = record.kind != RecordKind::kInitially;
    std::vector<const Node*> rest;
    for (const Node& part : node.children)
    {
      if (isTerm(part))
      {
        rest.push_back(&part);
      }
    }
    const std::size_t expected = (is_action ? 0U : 1U) + (has_step ? 1U : 0U);
    if (rest.size() != expected)
    {
      report(node, "found " + std::to_string(rest.size() + 1) + " arguments of " +
                       std::string(node.child(Rule::kRecordKind)->text) + ", expected " +
                       std::to_string(expected + 1) +
                       ": obs(literal, true or false, step), hpd(action, step), attempt(action, "
                       "step) or init(literal, true or false)");
      return;
    }
    const std::size_t before = problems_.size();
    record.value = is_action || valueOf(*rest.front());
    record.step = has_step ? stepOf(*rest.back()) : 0;
    if (const Node* confidence = node.child(Rule::kDecimal))
    {
      record.confidence = confidenceOf(*confidence);
    }
    record.statement = statementOf(*node.child(Rule::kCondition), is_action);
    if (problems_.size() == before)
    {
      records_.push_back(std::move(record));
    }
  }

  bool valueOf(const Node& node)
  {
    if (node.text != "true" && node.text != "false")
    {
      report(node, "found " + std::string(node.text) + ", expected true or false");
    }
    return node.text == "true";
  }

  int stepOf(const Node& node)
  {
    constexpr std::size_t kMaxDigits = 7;
    if (node.rule != Rule::kNumber || node.text[0] == '-' || node.text.size() > kMaxDigits)
    {
      report(node, "found " + quotedWord(node.text) + ", expected a step from 0 to 9999999");
      return 0;
    }
    return std::stoi(std::string(node.text));
  }

  double confidenceOf(const Node& node)
  {
    const double confidence = std::strtod(std::string(node.text.substr(0, 30)).c_str(), nullptr);
    if (!(confidence > 0.0 && confidence <= 1.0))
    {
      report(node, "found the confidence " + std::string(node.text.substr(0, 30)) +
                       ", expected one in (0, 1]");
    }
    return confidence;
  }

  /// The statement in the words of the language.
  std::string statementOf(const Node& node, bool is_action)
  {
    Builder builder(file_, &description_);
    std::string text;
    std::vector<Diagnostic> found;
    if (!is_action)
    {
      const Literal literal = normalized(builder.literal(node), description_);
      if (builder.problems.empty())
      {
        found = checkGround(literal, symbols_);
      }
      text = toString(literal, description_);
    }
    else if (node.children.size() == 1 && node.children[0].rule == Rule::kAtom)
    {
      const Atom action = builder.atom(node.children[0]);
      found = checkGroundAction(action, symbols_);
      text = toString(action);
    }
    else
    {
      report(node, "found a condition, expected a ground action");
    }
    for (auto* problems : {&builder.problems, &found})
    {
      problems_.insert(problems_.end(), problems->begin(), problems->end());
    }
    return text;
  }

  std::string file_;
  const Description& description_;
  const Symbols symbols_;
  std::vector<Diagnostic> problems_;
  std::vector<Record> records_;
};

}  // namespace

std::string toString(const Record& record)
{
  const std::string step = ", " + std::to_string(record.step) + ")";
  const std::string value = record.value ? ", true" : ", false";
  std::string text;
  switch (record.kind)
  {
    case RecordKind::kObserved:
      text = "obs(" + record.statement + value + step;
      break;
    case RecordKind::kHappened:
      text = "hpd(" + record.statement + step;
      break;
    case RecordKind::kAttempted:
      text = "attempt(" + record.statement + step;
      break;
    case RecordKind::kInitially:
      text = "init(" + record.statement + value + ")";
      break;
  }
  return record.confidence < 1.0 ? text + confidenceText(record.confidence) : text;
}

int doubtOf(const Record& record)
{
  constexpr double kScale = 100.0;
  const double odds = record.confidence / (1.0 - record.confidence);
  return static_cast<int>(std::max(1L, std::lround(kScale * std::log(odds))));
}

Literal normalized(Literal literal, const Description& description)
{
  const FluentDeclaration* fluent = description.findFluent(literal.atom.name);
  if (fluent != nullptr && !fluent->value_sort && !literal.equal)
  {
    literal.value.name = literal.value.name == "true" ? "false" : "true";
    literal.equal = true;
  }
  return literal;
}

Literal contrary(const Literal& literal, const Description& description)
{
  Literal opposite = literal;
  opposite.equal = !literal.equal;
  return normalized(std::move(opposite), description);
}

CheckedRecord checkRecord(const Record& record, const Symbols& symbols)
{
  const Description& description = symbols.description();
  CheckedRecord checked;
  checked.record = record;
  const auto refuse = [&](const std::string& why) {
    throw InvalidArgument(withoutNul("the record " + toString(record) + ": " + why));
  };
  if (record.step < 0 || (record.kind == RecordKind::kInitially && record.step != 0))
  {
    refuse("found step " + std::to_string(record.step) + ", expected " +
           (record.step < 0 ? "0 or more" : "0: init is about the initial state"));
  }
  if (!(record.confidence > 0.0 && record.confidence <= 1.0))
  {
    refuse("found confidence " + std::to_string(record.confidence) + ", expected one in (0, 1]");
  }
  try
  {
    if (checked.isAction())
    {
      checked.action = parseGroundAction(record.statement, symbols);
      checked.record.statement = toString(checked.action);
    }
    else
    {
      const Literal literal =
          normalized(parseGroundLiteral(record.statement, symbols), description);
      checked.record.statement = toString(literal, description);
      checked.literal = record.value ? literal : contrary(literal, description);
    }
  }
  catch (const InvalidArgument& e)
  {
    refuse(e.what());
  }
  return checked;
}

std::vector<Record> parseHistory(const std::string& text, const std::string& file,
                                 const Description& description)
{
  return HistoryReader(file, description).read(text);
}

std::vector<Record> readHistory(const std::string& path, const Description& description)
{
  return parseHistory(readTextFile(path), path, description);
}

}  // namespace kr3::reasoner
