#include "kr3_executive/knowledge_file.hpp"

#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

#include "memory_json.hpp"

namespace kr3::executive
{
namespace
{

using nlohmann::json;

constexpr int kVersion = 1;

/// @return null when there is no such file
json readDocument(const std::string& path)
{
  if (!std::filesystem::exists(path))
    return nullptr;
  std::ifstream file(path);
  if (!file)
    throw Unavailable("cannot read '" + path + "'");
  json document = json::parse(file);
  if (document.at("version").get<int>() != kVersion)
  {
    throw InvalidArgument(path + ": version " + document.at("version").dump() + ", expected " +
                          std::to_string(kVersion));
  }
  return document;
}

}  // namespace

void writeKnowledge(const std::string& path, const Knowledge& knowledge,
                    const std::optional<MissionUnderWay>& mission)
{
  json history = json::array();
  for (const auto& record : knowledge.history)
  {
    history.push_back({{"kind", static_cast<int>(record.kind)},
                       {"statement", record.statement},
                       {"value", record.value},
                       {"step", record.step},
                       {"confidence", record.confidence},
                       {"source", record.source}});
  }
  json document = {
      {"version", kVersion}, {"history", history}, {"memory", toJson(knowledge.memory)}};
  if (mission)
  {
    document["mission"] = {{"goal", mission->goal},
                           {"max_hl_actions", mission->max_hl_actions},
                           {"time_left_s", mission->time_left_s}};
  }

  const std::string fresh = path + ".new";
  {
    std::ofstream file(fresh);
    file << document.dump(1) << "\n";
    file.flush();
    if (!file)
      throw Unavailable("cannot write '" + fresh + "'");
  }
  std::error_code error;
  std::filesystem::rename(fresh, path, error);
  if (error)
    throw Unavailable("cannot replace '" + path + "': " + error.message());
}

std::optional<Knowledge> readKnowledge(const std::string& path)
{
  try
  {
    const json document = readDocument(path);
    if (document.is_null())
      return std::nullopt;
    Knowledge knowledge;
    for (const auto& item : document.at("history"))
    {
      const int kind = item.at("kind").get<int>();
      if (kind < 0 || kind > static_cast<int>(reasoner::RecordKind::kInitially))
        throw InvalidArgument(path + ": record kind " + std::to_string(kind));
      knowledge.history.push_back(
          {static_cast<reasoner::RecordKind>(kind), item.at("statement").get<std::string>(),
           item.at("value").get<bool>(), item.at("step").get<int>(),
           item.at("confidence").get<double>(), item.at("source").get<std::string>()});
    }
    knowledge.memory = memoryFromJson(document.at("memory"), path);
    return knowledge;
  }
  catch (const json::exception& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
}

std::optional<MissionUnderWay> readMissionUnderWay(const std::string& path)
{
  try
  {
    const json document = readDocument(path);
    if (document.is_null() || !document.contains("mission"))
      return std::nullopt;
    const json& item = document.at("mission");
    return MissionUnderWay{item.at("goal"), item.at("max_hl_actions"), item.at("time_left_s")};
  }
  catch (const json::exception& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
}

}  // namespace kr3::executive
