#include "kr3_common/ros/param_reader.hpp"

#include "kr3_common/error.hpp"

namespace kr3
{
namespace
{

template <typename T>
struct TypeName;
template <>
struct TypeName<bool>
{
  static constexpr const char* kText = "true or false";
};
template <>
struct TypeName<int>
{
  static constexpr const char* kText = "a whole number";
};
template <>
struct TypeName<double>
{
  static constexpr const char* kText = "a number";
};
template <>
struct TypeName<std::string>
{
  static constexpr const char* kText = "text";
};
template <>
struct TypeName<std::vector<std::string>>
{
  static constexpr const char* kText = "a list of texts";
};
template <>
struct TypeName<std::vector<double>>
{
  static constexpr const char* kText = "a list of numbers";
};

}  // namespace

ParamReader::ParamReader(const ros::NodeHandle& private_nh) : nh_(private_nh) {}

template <typename T>
T ParamReader::get(const std::string& name, const T& fallback)
{
  known_.insert(name);
  T value{};
  if (nh_.getParam(name, value))
    return value;
  if (nh_.hasParam(name))
    problems_.push_back("~" + name + " must be " + TypeName<T>::kText);
  return fallback;
}

template <typename T>
T ParamReader::require(const std::string& name)
{
  if (!nh_.hasParam(name))
    problems_.push_back("~" + name + " is missing: it must be " + TypeName<T>::kText);
  return get<T>(name, T{});
}

template bool ParamReader::get(const std::string&, const bool&);
template int ParamReader::get(const std::string&, const int&);
template double ParamReader::get(const std::string&, const double&);
template std::string ParamReader::get(const std::string&, const std::string&);
template std::vector<std::string> ParamReader::get(const std::string&,
                                                   const std::vector<std::string>&);
template std::vector<double> ParamReader::get(const std::string&, const std::vector<double>&);
template bool ParamReader::require(const std::string&);
template int ParamReader::require(const std::string&);
template double ParamReader::require(const std::string&);
template std::string ParamReader::require(const std::string&);
template std::vector<std::string> ParamReader::require(const std::string&);
template std::vector<double> ParamReader::require(const std::string&);

void ParamReader::check(bool ok, const std::string& name, const std::string& expectation)
{
  if (!ok)
    problems_.push_back("~" + name + " " + expectation);
}

void ParamReader::finish() const
{
  std::vector<std::string> problems = problems_;
  std::vector<std::string> names;
  nh_.getParamNames(names);
  const std::string prefix = nh_.getNamespace() + "/";
  for (const std::string& full : names)
  {
    if (full.compare(0, prefix.size(), prefix) != 0)
      continue;
    const std::string name = full.substr(prefix.size());
    // roscpp itself keeps its logger settings there; a nested name belongs to its first part.
    if (known_.count(name) == 0 && known_.count(name.substr(0, name.find('/'))) == 0)
      problems.push_back("~" + name +
                         " is unknown (misspelt, or left on the master by an earlier run?)");
  }
  if (problems.empty())
    return;
  std::string message = "bad parameters of " + nh_.getNamespace() + ":";
  for (const std::string& problem : problems)
    message += "\n  " + problem;
  throw InvalidArgument(message);
}

}  // namespace kr3
