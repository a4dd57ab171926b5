#include "kr3_executive/recorded_mission.hpp"

#include <algorithm>
#include <utility>

#include <kr3_common/error.hpp>

#include "input_json.hpp"

namespace kr3::executive
{
namespace
{

using nlohmann::json;

std::string placeOf(const RecordedInput& input)
{
  return "input " + std::to_string(input.sequence) + " (" + toString(input.kind) + "): ";
}

/// Does what `read` says; what goes wrong names the input.
template <typename Read>
auto withPlace(const RecordedInput& input, Read read)
{
  try
  {
    return read(json::parse(input.data));
  }
  catch (const json::exception& e)
  {
    throw InvalidArgument(placeOf(input) + e.what());
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(placeOf(input) + e.what());
  }
}

void expectKind(const std::vector<RecordedInput>& mission, std::size_t index, InputKind kind)
{
  if (index >= mission.size())
    throw InvalidArgument("the recording ends before the mission's start (no " +
                          std::string(toString(kind)) + ")");
  if (mission[index].kind != kind)
    throw InvalidArgument(placeOf(mission[index]) + "expected " + toString(kind));
}

RecordedEnd endFromJson(const json& item)
{
  const std::string reason = item.at("reason");
  if (reason == "cancelled")
    return {};
  if (reason == "time")
    return {RecordedEnd::Reason::kTime, ErrorCode::kDeadlineExceeded, {}};
  if (reason == "refused")
    return {RecordedEnd::Reason::kRefused, codeFromJson(item), item.at("message")};
  throw InvalidArgument("reason '" + reason + "', expected cancelled, time or refused");
}

RecordedItem itemOf(const RecordedInput& input)
{
  RecordedItem item{input.sequence, input.stamp_s, {}};
  withPlace(input, [&](const json& data) {
    switch (input.kind)
    {
      case InputKind::kSkillResult:
        item.content = skillFromJson(data);
        break;
      case InputKind::kTold:
        item.content = toldFromJson(data);
        break;
      case InputKind::kCancel:
        item.content = endFromJson(data);
        break;
      case InputKind::kDecision:
        item.content = decisionFromJson(data);
        break;
      case InputKind::kDomain:
      case InputKind::kMission:
        throw InvalidArgument("expected at the mission's start only");
    }
  });
  return item;
}

json listOf(const std::string& values)
{
  json list = json::array();
  for (std::size_t begin = 0; begin <= values.size();)
  {
    const std::size_t end = std::min(values.find(',', begin), values.size());
    list.push_back(values.substr(begin, end - begin));
    begin = end + 1;
  }
  return list;
}

/// What a text replaces a value with: of the value's own type where the text can be read so.
json replacementOf(const json& old, const std::string& text)
{
  const json parsed = json::parse(text, nullptr, false);
  if (old.is_array())
    return parsed.is_array() ? parsed : listOf(text);
  if (old.is_string())
    return parsed.is_string() ? parsed : json(text);
  if (parsed.is_discarded())
    throw InvalidArgument("value '" + text + "', expected one like " + old.dump());
  return parsed;
}

}  // namespace

bool RecordedMission::isComplete() const
{
  return std::any_of(items.begin(), items.end(), [](const RecordedItem& item) {
    const auto* decision = std::get_if<ReportedDecision>(&item.content);
    return decision != nullptr && decision->kind == "finish";
  });
}

std::vector<std::vector<RecordedInput>> splitMissions(const std::vector<RecordedInput>& inputs)
{
  if (inputs.empty())
    throw InvalidArgument("there are no inputs of a mission");
  std::vector<std::vector<RecordedInput>> missions;
  for (const auto& input : inputs)
  {
    if (input.kind == InputKind::kDomain)
      missions.emplace_back();
    if (missions.empty())
      throw InvalidArgument(placeOf(input) + "the recording begins in the middle of a mission; " +
                            "what came before is missing");
    missions.back().push_back(input);
  }
  return missions;
}

void alter(std::vector<RecordedInput>& mission, const std::string& change)
{
  const std::size_t dot = change.find('.');
  const std::size_t equals = change.find('=');
  const std::string number = change.substr(0, dot);
  if (equals == std::string::npos || dot > equals || number.empty() || number.size() > 9 ||
      number.find_first_not_of("0123456789") != std::string::npos)
    throw InvalidArgument("change '" + change + "', expected NUMBER.FIELD=VALUE");
  const std::uint32_t sequence = static_cast<std::uint32_t>(std::stoul(number));
  const auto input = std::find_if(mission.begin(), mission.end(),
                                  [&](const auto& known) { return known.sequence == sequence; });
  if (input == mission.end())
    throw InvalidArgument("change '" + change + "': there is no input " + number);
  std::string path = "/" + change.substr(dot + 1, equals - dot - 1);
  std::replace(path.begin(), path.end(), '.', '/');
  input->data = withPlace(*input, [&](json data) {
    json& field = data.at(json::json_pointer(path));
    field = replacementOf(field, change.substr(equals + 1));
    return data.dump();
  });
}

RecordedMission readMission(const std::vector<RecordedInput>& mission)
{
  expectKind(mission, 0, InputKind::kDomain);
  for (std::size_t i = 0; i < mission.size(); ++i)
  {
    if (mission[i].sequence != i)
      throw InvalidArgument(placeOf(mission[i]) + "expected input " + std::to_string(i) +
                            "; inputs are missing or out of order");
  }
  expectKind(mission, 1, InputKind::kMission);
  RecordedMission recorded{
      withPlace(mission[0], domainFromJson),
      withPlace(mission[1], [](const json& data) { return planOptionsFromJson(data.at("plan")); }),
      withPlace(
          mission[1],
          [](const json& data) {
    return data.contains("method") ? methodFromJson(data.at("method")) : PlanningMethod{};
          }),
      withPlace(mission[1], missionFromJson),
      mission[1].stamp_s,
      {}};
  for (std::size_t i = 2; i < mission.size(); ++i)
    recorded.items.push_back(itemOf(mission[i]));
  return recorded;
}

}  // namespace kr3::executive
