#include "kr3_executive/mission_recording.hpp"

#include <array>
#include <istream>
#include <utility>

#include <kr3_common/error.hpp>

#include "input_json.hpp"

namespace kr3::executive
{
namespace
{

using nlohmann::json;

constexpr std::array<const char*, 6> kKinds{"DOMAIN", "MISSION", "SKILL_RESULT",
                                            "TOLD",   "CANCEL",  "DECISION"};

InputKind kindFromName(const std::string& name)
{
  for (std::size_t i = 0; i < kKinds.size(); ++i)
  {
    if (name == kKinds[i])
      return static_cast<InputKind>(i);
  }
  throw InvalidArgument("kind '" + name + "', expected DOMAIN, MISSION, SKILL_RESULT, TOLD, " +
                        "CANCEL or DECISION");
}

RecordedInput fromJsonLine(const std::string& line)
{
  const json item = json::parse(line);
  const json& data = item.at("data");
  if (!data.is_object())
    throw InvalidArgument("data is no object");
  return {item.at("sequence"), kindFromName(item.at("kind")), item.at("stamp_s"), data.dump()};
}

}  // namespace

const char* toString(InputKind kind)
{
  return kKinds.at(static_cast<std::size_t>(kind));
}

std::string toJsonLine(const RecordedInput& input)
{
  return R"({"sequence": )" + std::to_string(input.sequence) + R"(, "kind": ")" +
         toString(input.kind) + R"(", "stamp_s": )" + json(input.stamp_s).dump() + R"(, "data": )" +
         input.data + "}";
}

std::vector<RecordedInput> readInputs(std::istream& lines, const std::string& name)
{
  std::vector<RecordedInput> inputs;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number)
  {
    if (line.find_first_not_of(" \t\r") == std::string::npos)
      continue;
    const std::string place = name + ":" + std::to_string(number) + ": ";
    try
    {
      inputs.push_back(fromJsonLine(line));
    }
    catch (const json::exception& e)
    {
      throw InvalidArgument(place + e.what());
    }
    catch (const InvalidArgument& e)
    {
      throw InvalidArgument(place + e.what());
    }
  }
  return inputs;
}

MissionRecorder::MissionRecorder(const DomainFiles& domain, const reasoner::PlanOptions& plan,
                                 Clock clock, Sink sink, const PlanningMethod& method)
  : domain_(toJson(domain).dump())
  , plan_(toJson(plan).dump())
  , method_(toJson(method).dump())
  , clock_(std::move(clock))
  , sink_(std::move(sink))
{
}

void MissionRecorder::onInput(const Input& input)
{
  if (const auto* mission = std::get_if<MissionBegun>(&input))
  {
    sequence_ = 0;
    begun_ = true;
    add(InputKind::kDomain, domain_);
    json data = toJson(*mission);
    data["plan"] = json::parse(plan_);
    data["method"] = json::parse(method_);
    add(InputKind::kMission, data.dump());
  }
  else if (const auto* skill = std::get_if<SkillEnded>(&input))
    add(InputKind::kSkillResult, toJson(*skill).dump());
  else if (const auto* told = std::get_if<FactTold>(&input))
    add(InputKind::kTold, toJson(*told).dump());
  else if (const auto* refused = std::get_if<RequestRefused>(&input))
    add(InputKind::kCancel, json({{"reason", "refused"},
                                  {"code", static_cast<int>(refused->code)},
                                  {"message", refused->message}})
                                .dump());
  else if (std::holds_alternative<TimeExpired>(input))
    add(InputKind::kCancel, R"({"reason": "time"})");
  else
    add(InputKind::kCancel, R"({"reason": "cancelled"})");
}

void MissionRecorder::onDecision(const ReportedDecision& decision)
{
  add(InputKind::kDecision, toJson(decision).dump());
}

void MissionRecorder::add(InputKind kind, std::string data)
{
  if (!begun_)
    return;
  sink_({sequence_, kind, clock_(), std::move(data)});
  ++sequence_;
}

}  // namespace kr3::executive
