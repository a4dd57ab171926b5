#include "policy_services.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

#include <unistd.h>

#include <kr3_common/error.hpp>
#include <kr3_msgs/GetPolicyInfo.h>
#include <kr3_msgs/ListPolicies.h>
#include <kr3_msgs/LoadPolicy.h>
#include <kr3_msgs/ReleasePolicy.h>
#include <kr3_msgs/SavePolicy.h>

#include "../file_text.hpp"
#include "conversions.hpp"
#include "kr3_pomdp/names.hpp"
#include "kr3_pomdp/policy_bundle.hpp"
#include "kr3_pomdp/policy_format.hpp"

namespace kr3::pomdp
{

namespace
{

namespace fs = std::filesystem;

fs::path rosHome()
{
  if (const char* home = std::getenv("ROS_HOME"))
  {
    return home;
  }
  if (const char* home = std::getenv("HOME"))
  {
    return fs::path(home) / ".ros";
  }
  return fs::temp_directory_path() / "ros";
}

void getPolicyInfo(PolicyStore& store, const kr3_msgs::GetPolicyInfo::Request& request,
                   kr3_msgs::GetPolicyInfo::Response& response)
{
  const StoredPolicy stored = store.info(request.policy_id);
  const Model& model = stored.solved->model();
  response.summary = toMsg(stored);
  for (std::size_t s = 0; s < model.numStates(); ++s)
  {
    response.states.push_back(model.stateName(s));
  }
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    response.actions.push_back(model.actionName(a));
  }
  for (std::size_t o = 0; o < model.numObservations(); ++o)
  {
    response.observations.push_back(model.observationName(o));
  }
  for (const SparseEntry& entry : sparse(model.initialBelief()))
  {
    response.initial_states.push_back(entry.index);
    response.initial_belief.push_back(entry.probability);
  }
}

std::string textOf(const SolvedModel& solved, std::uint8_t format)
{
  using Request = kr3_msgs::SavePolicy::Request;
  std::ostringstream out;
  if (format == Request::BUNDLE)
  {
    writeBundle(out, solved);
    return out.str();
  }
  if (format != Request::POLICY && format != Request::APPL)
  {
    throw InvalidArgument("format " + std::to_string(format) + ", expected BUNDLE, POLICY or APPL");
  }
  if (!solved.policy)
  {
    throw FailedPrecondition("it is a model without a policy");
  }
  if (format == Request::POLICY)
  {
    solved.policy->write(out);
  }
  else
  {
    writeApplPolicy(out, *solved.policy, solved.model(), "model." + solved.source->text.format);
  }
  return out.str();
}

void savePolicy(PolicyStore& store, const PolicyFiles& files,
                const kr3_msgs::SavePolicy::Request& request,
                kr3_msgs::SavePolicy::Response& response)
{
  std::string text = textOf(*store.policy(request.policy_id), request.format);
  if (request.file_name.empty())
  {
    response.text = std::move(text);
  }
  else
  {
    response.path = files.save(request.file_name, text);
  }
}

SolvedModel modelFrom(PolicyStore& store, const kr3_msgs::LoadPolicy::Request& request,
                      const LoadLimits& limits)
{
  ModelText text = checkedModelText(request.model_format, request.model, limits.max_model_bytes);
  std::shared_ptr<const NamedModel> source = store.findModel(text);
  if (!source)
  {
    Model model = readModel(text, "model", limits.read);
    source = std::make_shared<const NamedModel>(NamedModel{std::move(text), std::move(model)});
  }
  std::optional<Policy> policy;
  if (!request.policy.empty())
  {
    std::istringstream in(request.policy);
    policy = looksLikeXml(request.policy) ? readApplPolicy(in, "policy", source->model)
                                          : Policy::read(in, "policy");
  }
  return unsolvedModel(std::move(source), std::move(policy));
}

void loadPolicy(PolicyStore& store, const PolicyFiles& files, const LoadLimits& limits,
                const kr3_msgs::LoadPolicy::Request& request,
                kr3_msgs::LoadPolicy::Response& response)
{
  const int num_sources = static_cast<int>(!request.file_name.empty()) +
                          static_cast<int>(!request.bundle.empty()) +
                          static_cast<int>(!request.model.empty());
  if (num_sources != 1)
  {
    throw InvalidArgument("found " + std::to_string(num_sources) +
                          " of file_name, bundle and model, expected one");
  }
  if (request.model.empty() && !(request.policy.empty() && request.model_format.empty()))
  {
    throw InvalidArgument("a bundle has its policy and format itself, found another");
  }
  SolvedModel solved = !request.file_name.empty() ? files.load(request.file_name, limits.read)
                       : !request.bundle.empty()  ? files.parse(request.bundle, limits.read)
                                                  : modelFrom(store, request, limits);
  response.policy_id = store.put(std::make_shared<const SolvedModel>(std::move(solved)));
  response.summary = toMsg(store.info(response.policy_id));
}

}  // namespace

PolicyFiles::PolicyFiles(const std::string& directory, std::size_t max_bytes)
  : directory_(directory.empty() ? rosHome() / "kr3_policies" : fs::path(directory))
  , max_bytes_(max_bytes)
{
}

fs::path PolicyFiles::pathOf(const std::string& name) const
{
  const bool plain = !name.empty() && name.size() <= 200 && name.front() != '.' &&
                     name.find('/') == std::string::npos && name.find('\0') == std::string::npos;
  if (!plain)
  {
    throw InvalidArgument("file name '" + name.substr(0, 200) +
                          "', expected a name without '/' that does not begin with '.'");
  }
  return directory_ / name;
}

std::string PolicyFiles::save(const std::string& name, const std::string& text) const
{
  const fs::path path = pathOf(name);
  const std::lock_guard<std::mutex> lock(*saving_);
  fs::path draft = path;
  draft += "." + std::to_string(getpid()) + ".draft";
  std::error_code error;
  fs::create_directories(directory_, error);
  std::ofstream out(draft, std::ios::binary);
  out << text;
  out.close();
  if (out)
  {
    fs::rename(draft, path, error);
  }
  if (!out || error)
  {
    std::error_code ignored;
    fs::remove(draft, ignored);
    throw Unavailable("cannot write '" + path.string() + "'" +
                      (error ? ": " + error.message() : ""));
  }
  return path.string();
}

SolvedModel PolicyFiles::load(const std::string& name, const ReadOptions& options) const
{
  const fs::path path = pathOf(name);
  std::error_code error;
  if (!fs::is_regular_file(path, error))
  {
    throw NotFound("no file '" + path.string() + "'");
  }
  std::ifstream in(path, std::ios::binary);
  if (!in)
  {
    throw Unavailable("cannot open '" + path.string() + "'");
  }
  return readBundle(in, name, max_bytes_, options);
}

SolvedModel PolicyFiles::parse(const std::string& text, const ReadOptions& options) const
{
  std::istringstream in(text);
  return readBundle(in, "bundle", max_bytes_, options);
}

void offerPolicyServices(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                         ServiceList& services)
{
  services.offer<kr3_msgs::ListPolicies>(nh, names::kListPolicies,
                                         [store](const auto& /*request*/, auto& response) {
    for (const StoredPolicy& stored : store->policies())
    {
      response.policies.push_back(toMsg(stored));
    }
    response.memory_bytes = store->statistics().bytes;
    response.max_memory_bytes = store->limits().max_bytes;
  });
  services.offer<kr3_msgs::GetPolicyInfo>(
      nh, names::kGetPolicyInfo,
      [store](const auto& request, auto& response) { getPolicyInfo(*store, request, response); });
  services.offer<kr3_msgs::ReleasePolicy>(nh, names::kReleasePolicy,
                                          [store](const auto& request, auto& response) {
    response.num_beliefs = static_cast<std::uint32_t>(store->release(request.policy_id));
  });
}

void offerFileServices(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                       const PolicyFiles& files, const LoadLimits& limits, ServiceList& services)
{
  services.offer<kr3_msgs::SavePolicy>(nh, names::kSavePolicy,
                                       [store, files](const auto& request, auto& response) {
    savePolicy(*store, files, request, response);
  });
  services.offer<kr3_msgs::LoadPolicy>(nh, names::kLoadPolicy,
                                       [store, files, limits](const auto& request, auto& response) {
    loadPolicy(*store, files, limits, request, response);
  });
}

}  // namespace kr3::pomdp
