#include "record_reader.hpp"

#include <cmath>
#include <map>

#include <kr3_common/error.hpp>

namespace kr3::executive
{

using reasoner::Record;
using reasoner::RecordKind;

namespace
{
constexpr double kLastStep = 1e6;
}  // namespace

Record readRecord(YamlReader& reader, const YAML::Node& node,
                  const reasoner::Description& high_level)
{
  static const std::map<std::string, RecordKind> kKinds{{"init", RecordKind::kInitially},
                                                        {"obs", RecordKind::kObserved},
                                                        {"hpd", RecordKind::kHappened},
                                                        {"attempt", RecordKind::kAttempted}};
  reader.checkKeys(node, {"kind", "statement", "value", "step", "confidence"});
  Record record;
  record.source = "scenario";
  record.statement = reader.text(node, "statement");
  record.value = reader.truth(node, "value", true);
  const double step = reader.number(node, "step", 0.0);
  if (step >= 0.0 && step <= kLastStep && std::floor(step) == step)
    record.step = static_cast<int>(step);
  else
    reader.problem(node, "'step' is " + std::to_string(step) + ", expected a whole number from 0");
  record.confidence = reader.number(node, "confidence", 1.0);
  const std::string kind = reader.text(node, "kind");
  const auto known = kKinds.find(kind);
  if (known == kKinds.end())
  {
    reader.problem(node, "kind '" + kind + "', expected init, obs, hpd or attempt");
    return record;
  }
  record.kind = known->second;
  if (!(record.confidence > 0.0 && record.confidence <= 1.0))
    reader.problem(node, "confidence outside (0, 1]");
  try
  {
    if (record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted)
      static_cast<void>(reasoner::parseGroundAction(record.statement, high_level));
    else
      static_cast<void>(reasoner::parseGroundLiteral(record.statement, high_level));
  }
  catch (const InvalidArgument& e)
  {
    reader.problem(node, e.what());
  }
  return record;
}

}  // namespace kr3::executive
