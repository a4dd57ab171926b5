#pragma once

#include <string>

#include "kr3_executive/model_fingerprint.hpp"
#include "kr3_executive/policy_cache.hpp"

namespace kr3::executive
{

/// Writes a policy to a file of its own, so that a reader sees all of it or nothing.
/// @throws Unavailable  it cannot be written
void writePolicyFile(const std::string& path, const Fingerprint& key, const CachedPolicy& policy);

/// Reads what writePolicyFile wrote, to the last bit.
/// @throws Unavailable      there is no such file, or it cannot be read
/// @throws InvalidArgument  of another version, for another key, cut off or changed
[[nodiscard]] CachedPolicy readPolicyFile(const std::string& path, const Fingerprint& key);

}  // namespace kr3::executive
