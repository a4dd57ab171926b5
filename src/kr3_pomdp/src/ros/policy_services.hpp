#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include <ros/node_handle.h>

#include "kr3_pomdp/policy_store.hpp"
#include "kr3_pomdp/read_options.hpp"
#include "service_list.hpp"

namespace kr3::pomdp
{

/// Files of policies in one directory.
///
/// Thread-safe; copies write one after the other, too.
class PolicyFiles
{
public:
  /// @param directory  empty = kr3_policies in ROS's home directory; made when something is saved
  /// @param max_bytes  of a file that is read
  PolicyFiles(const std::string& directory, std::size_t max_bytes);

  /// Writes a file as a whole or not at all.
  /// @return its path
  /// @throws InvalidArgument  a name that is no plain file name; Unavailable  it cannot be written
  [[nodiscard]] std::string save(const std::string& name, const std::string& text) const;
  /// @throws InvalidArgument  a name that is no plain file name, or no bundle
  /// @throws NotFound         no such file; Unavailable  it cannot be read
  [[nodiscard]] SolvedModel load(const std::string& name, const ReadOptions& options) const;
  /// Reads the text of a bundle.
  /// @throws InvalidArgument  no bundle
  [[nodiscard]] SolvedModel parse(const std::string& text, const ReadOptions& options) const;

private:
  [[nodiscard]] std::filesystem::path pathOf(const std::string& name) const;

  std::filesystem::path directory_;
  std::size_t max_bytes_;
  std::shared_ptr<std::mutex> saving_ =
      std::make_shared<std::mutex>();  // held while a file is written
};

/// What load_policy takes in at most.
struct LoadLimits
{
  std::size_t max_model_bytes;
  ReadOptions read;  ///< its callback ends loading when the node does
};

/// Offers to list, describe and forget policies, all of it quick.
void offerPolicyServices(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                         ServiceList& services);

/// Offers to save and load policies, which may take seconds.
void offerFileServices(ros::NodeHandle& nh, const std::shared_ptr<PolicyStore>& store,
                       const PolicyFiles& files, const LoadLimits& limits, ServiceList& services);

}  // namespace kr3::pomdp
