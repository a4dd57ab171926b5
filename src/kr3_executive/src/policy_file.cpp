#include "policy_file.hpp"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <thread>

#include <unistd.h>

#include <kr3_common/error.hpp>

namespace kr3::executive
{
namespace
{

/// Raised when the text changes, and when the solver finds other policies by the same counted work.
const std::string kHeading = "kr3 cached policy 1";

std::string checksum(const std::string& text)
{
  Fingerprinter fingerprinter;
  for (const char c : text)
    fingerprinter.add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
  return toString(fingerprinter.result());
}

std::string firstLine(const Fingerprint& key, const std::string& body)
{
  return kHeading + " " + toString(key) + " " + checksum(body);
}

}  // namespace

void writePolicyFile(const std::string& path, const Fingerprint& key, const CachedPolicy& policy)
{
  std::ostringstream body;
  char bounds[128];
  std::snprintf(bounds, sizeof bounds, "%.17g %.17g %llu %.17g\n", policy.lower, policy.upper,
                static_cast<unsigned long long>(policy.backups), policy.cpu_s);
  body << bounds;
  policy.policy.write(body);
  // Other processes and threads may write the same policy.
  std::ostringstream own;
  own << path << '.' << ::getpid() << '.' << std::this_thread::get_id();
  {
    std::ofstream out(own.str(), std::ios::binary);
    out << firstLine(key, body.str()) << '\n' << body.str();
    out.close();
    if (!out)
      throw Unavailable("cannot write '" + own.str() + "'");
  }
  std::error_code error;
  std::filesystem::rename(own.str(), path, error);
  if (error)
  {
    std::error_code ignored;
    std::filesystem::remove(own.str(), ignored);
    throw Unavailable("cannot write '" + path + "': " + error.message());
  }
}

CachedPolicy readPolicyFile(const std::string& path, const Fingerprint& key)
{
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw Unavailable("cannot read '" + path + "'");
  std::string heading;
  std::getline(in, heading);
  const std::string body{std::istreambuf_iterator<char>(in), {}};
  if (heading != firstLine(key, body))
  {
    throw InvalidArgument("'" + path + "' is damaged, of another version or for another model: '" +
                          heading.substr(0, 100) + "'");
  }
  std::istringstream text(body);
  double lower = 0.0;
  double upper = 0.0;
  std::uint64_t backups = 0;
  double cpu_s = 0.0;
  text >> lower >> upper >> backups >> cpu_s;
  text.ignore();
  return {pomdp::Policy::read(text, path), lower, upper, backups, cpu_s};
}

}  // namespace kr3::executive
