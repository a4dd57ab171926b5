#include "kr3_pomdp/policy_format.hpp"

#include <fstream>
#include <string>

#include <kr3_common/error.hpp>

#include "file_text.hpp"

namespace kr3::pomdp
{

void checkFits(const Policy& policy, const Model& model)
{
  if (policy.numStates() != model.numStates() || policy.maxAction() >= model.numActions())
  {
    throw InvalidArgument("a policy over " + std::to_string(policy.numStates()) +
                          " states with actions up to " + std::to_string(policy.maxAction()) +
                          ", expected " + std::to_string(model.numStates()) + " states and " +
                          std::to_string(model.numActions()) + " actions");
  }
}

Policy loadPolicy(const std::string& path, const Model& model)
{
  std::ifstream in(path, std::ios::binary);
  std::string line;
  const bool xml = in && std::getline(in >> std::ws, line) && looksLikeXml(line);
  return loadPolicy(path, model, xml ? PolicyFormat::kAppl : PolicyFormat::kKr3);
}

Policy loadPolicy(const std::string& path, const Model& model, PolicyFormat format)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
  {
    throw Unavailable("cannot open '" + path + "'");
  }
  if (format == PolicyFormat::kAppl)
  {
    return readApplPolicy(in, path, model);
  }
  Policy policy = Policy::read(in, path);
  try
  {
    checkFits(policy, model);
  }
  catch (const InvalidArgument& e)
  {
    throw InvalidArgument(path + ": " + e.what());
  }
  return policy;
}

}  // namespace kr3::pomdp
