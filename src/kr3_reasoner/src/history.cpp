#include "history.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include <kr3_common/error.hpp>

#include "builder.hpp"
#include "check.hpp"
#include "grammar.hpp"
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

RecordKind kindOf(const std::string& word)
{
  return word == "obs"       ? RecordKind::kObserved
         : word == "hpd"     ? RecordKind::kHappened
         : word == "attempt" ? RecordKind::kAttempted
                             : RecordKind::kInitially;
}

/// The record of one statement of a history file; nothing when it is wrong,
/// which is reported.
std::optional<Record> recordOf(const Node& node, std::vector<Diagnostic>& problems)
{
  Record record;
  record.position = node.position;
  record.kind = kindOf(node.child(Rule::kRecordKind)->text);
  const bool is_action =
      record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
  const bool is_literal = !is_action;
  std::vector<std::string> rest;
  for (const Node& part : node.children)
  {
    if (part.rule == Rule::kName || part.rule == Rule::kNumber || part.rule == Rule::kVariable)
    {
      rest.push_back(part.text);
    }
    else if (part.rule == Rule::kCondition)
    {
      record.statement = part.text;
      record.statement.erase(record.statement.find_last_not_of(" \t\r\n") + 1);
    }
    else if (part.rule == Rule::kDecimal)
    {
      record.confidence = std::stod(part.text);
    }
  }
  const bool has_step = record.kind != RecordKind::kInitially;
  const std::size_t expected = (is_literal ? 1U : 0U) + (has_step ? 1U : 0U);
  const auto isStep = [](const std::string& text) {
    return text.size() < 8 && text.find_first_not_of("0123456789") == std::string::npos;
  };
  if (rest.size() != expected || (is_literal && rest[0] != "true" && rest[0] != "false") ||
      (has_step && !isStep(rest.back())))
  {
    problems.push_back({node.position,
                        "expected obs(literal, true or false, step), hpd(action, step), "
                        "attempt(action, step) or init(literal, true or false)"});
    return std::nullopt;
  }
  record.value = is_action || rest[0] == "true";
  record.step = has_step ? std::stoi(rest.back()) : 0;
  return record;
}

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

CheckedRecord checkRecord(const Record& record, const Description& description)
{
  CheckedRecord checked;
  checked.record = record;
  const auto refuse = [&](const std::string& why) {
    throw InvalidArgument("the record " + toString(record) + ": " + why);
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
      checked.action = parseGroundAction(record.statement, description);
      checked.record.statement = toString(checked.action);
    }
    else
    {
      const Literal literal =
          normalized(parseGroundLiteral(record.statement, description), description);
      checked.record.statement = toString(literal);
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
  std::vector<Record> records;
  std::vector<Diagnostic> problems;
  for (const grammar::Chunk& chunk : grammar::split(text, file))
  {
    const Node node = grammar::parse(grammar::Kind::kRecord, chunk.text, chunk.position, problems);
    if (node.rule == Rule::kNone)
    {
      continue;
    }
    const std::optional<Record> record = recordOf(node, problems);
    if (!record)
    {
      continue;
    }
    try
    {
      records.push_back(checkRecord(*record, description).record);
    }
    catch (const InvalidArgument& e)
    {
      problems.push_back({chunk.position, e.what()});
    }
  }
  throwIfAny(problems);
  return records;
}

std::vector<Record> readHistory(const std::string& path, const Description& description)
{
  return parseHistory(readTextFile(path), path, description);
}

}  // namespace kr3::reasoner
