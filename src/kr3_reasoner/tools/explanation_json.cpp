#include "explanation_json.hpp"

namespace kr3::reasoner::tool
{

namespace
{

const char* nameOf(ReasonKind kind)
{
  switch (kind)
  {
    case ReasonKind::kObserved:
      return "observed";
    case ReasonKind::kHappened:
      return "happened";
    case ReasonKind::kCaused:
      return "caused";
    case ReasonKind::kInertia:
      return "inertia";
    case ReasonKind::kConstraint:
      return "constraint";
    case ReasonKind::kDefinition:
      return "definition";
    case ReasonKind::kExecutability:
      return "executability";
    case ReasonKind::kOnlyValue:
      return "only_value";
    case ReasonKind::kStatic:
      return "static";
    case ReasonKind::kDefault:
      return "default";
    case ReasonKind::kException:
      return "exception";
    case ReasonKind::kAssumed:
      return "assumed";
    case ReasonKind::kChange:
      return "change";
    case ReasonKind::kContradiction:
      return "contradiction";
    case ReasonKind::kSupposed:
      return "supposed";
    case ReasonKind::kCases:
      return "cases";
    case ReasonKind::kTogether:
      return "together";
    case ReasonKind::kAgain:
      return "again";
    case ReasonKind::kCarried:
      return "carried";
  }
  return "together";
}

const char* nameOf(LawKind kind)
{
  return kind == LawKind::kCausal       ? "causal law"
         : kind == LawKind::kConstraint ? "state constraint"
         : kind == LawKind::kDefinition ? "definition"
                                        : "executability condition";
}

Json positionJson(const SourcePosition& position)
{
  if (position.line == 0)
  {
    return nullptr;
  }
  return {{"file", position.file}, {"line", position.line}};
}

}  // namespace

Json proofJson(const Reason& reason)
{
  Json json = {{"kind", nameOf(reason.kind)},
               {"statement", reason.statement},
               {"step", reason.step},
               {"sentence", reason.sentence},
               {"record", nullptr},
               {"default", nullptr},
               {"source", positionJson(reason.position)},
               {"children", Json::array()}};
  if (reason.record != kNoRecord)
  {
    json["record"] = reason.record;
  }
  if (!reason.default_name.empty())
  {
    json["default"] = reason.default_name;
  }
  for (const Reason& child : reason.children)
  {
    json["children"].push_back(proofJson(child));
  }
  return json;
}

Json lawsJson(const std::vector<CitedLaw>& laws)
{
  Json list = Json::array();
  for (const CitedLaw& law : laws)
  {
    Json sources = Json::array();
    for (const SourcePosition& position : law.positions)
    {
      sources.push_back(positionJson(position));
    }
    list.push_back({{"kind", nameOf(law.kind)}, {"about", law.about}, {"sources", sources}});
  }
  return list;
}

}  // namespace kr3::reasoner::tool
