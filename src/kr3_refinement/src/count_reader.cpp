// ActionModelReader: sample sizes, and whether the probabilities agree with them.

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "action_model_reader.hpp"

namespace kr3::refinement
{
namespace
{

constexpr double kMostPseudoCounts = 1e6;
constexpr double kSumTolerance = 1e-6;
/// Probabilities in a file are rounded to two digits after the point, or better.
constexpr double kRounding = 0.0051;

}  // namespace

ModelSource ActionModelReader::readSource(const std::string& what, const YAML::Node& node,
                                          const Counts& counts)
{
  const YAML::Node source = YamlFile::entry(node, "source");
  const std::string text = source.IsDefined() && source.IsScalar() ? source.Scalar() : "";
  if (text != "learned" && text != "hand-written")
  {
    file_.report(source.IsDefined() ? source : node,
                 what + ": source " + YamlFile::shown(source) +
                     ", expected 'learned' or 'hand-written'" +
                     suggestion(text, {"learned", "hand-written"}));
  }
  const bool any =
      std::any_of(counts.begin(), counts.end(), [](const auto& entry) { return entry.second > 0; });
  if (text == "learned" && !any)
  {
    file_.report(node, what +
                           ": learned without counts; give the sample sizes, or say 'source: "
                           "hand-written'");
  }
  if (text == "hand-written" && any)
  {
    file_.report(source, what +
                             ": hand-written, but there are counts; say 'source: learned', or "
                             "leave them out");
  }
  return text == "learned" ? ModelSource::kLearned : ModelSource::kHandWritten;
}

ActionModelReader::Counts ActionModelReader::readCounts(const std::string& what,
                                                        const YAML::Node& node,
                                                        const std::vector<std::string>& keys)
{
  Counts counts;
  if (!node.IsDefined() || !file_.checkMap(node, what + ", counts", keys))
  {
    return counts;
  }
  for (const std::string& key : keys)
  {
    const YAML::Node entry = YamlFile::entry(node, key);
    if (!entry.IsDefined())
    {
      file_.report(node, what + ": found no count of '" + key + "', expected one for each of " +
                             listed(keys));
      continue;
    }
    counts[key] = file_.count(entry, what + ", counts, " + key).value_or(0);
  }
  return counts;
}

std::optional<double> ActionModelReader::readPrior(const std::string& what, const YAML::Node& node,
                                                   const Counts& counts)
{
  const YAML::Node prior = YamlFile::entry(node, "prior");
  if (!prior.IsDefined())
  {
    return std::nullopt;
  }
  if (counts.empty())
  {
    file_.report(prior, what + ": a prior without counts; leave it out, or give the sample sizes");
  }
  return file_.number(node, "prior", 0.0, 0.0, kMostPseudoCounts);
}

std::optional<double> ActionModelReader::contradicted(double probability, std::uint64_t count,
                                                      std::uint64_t total, std::size_t values,
                                                      std::optional<double> prior)
{
  const auto n = static_cast<double>(total);
  const auto k = static_cast<double>(count);
  const auto mean = [&](double pseudo) {
    return (k + pseudo) / std::max(n + static_cast<double>(values) * pseudo, 1e-12);
  };
  // Without a prior said: between the relative frequency and Laplace's rule.
  const double least = std::min(mean(prior.value_or(0.0)), prior ? mean(*prior) : k / (n + 2.0));
  const double most = std::max(mean(prior.value_or(0.0)), prior ? mean(*prior) : (k + 1) / (n + 2));
  const bool fits =
      total == 0 || (probability >= least - kRounding && probability <= most + kRounding);
  return fits ? std::nullopt : std::optional(prior ? mean(*prior) : (k + 0.5) / (n + 1.0));
}

void ActionModelReader::compare(const std::string& what, const YAML::Node& node, double probability,
                                std::uint64_t count, std::uint64_t total,
                                std::optional<double> prior)
{
  if (const auto expected = contradicted(probability, count, total, 2, prior))
  {
    std::ostringstream message;
    message << what << ": probability " << probability << " contradicts its counts, " << count
            << " of " << total << "; expected about " << *expected;
    file_.report(node, message.str());
  }
}

/// Each probability with the counts of the labels that are drawn together with it: all of them, or
/// those of a law that has it.
void ActionModelReader::compareCounts(const std::string& what, const YAML::Node& node,
                                      const OutcomeModel& model)
{
  if (model.counts.size() != model.probabilities.size())
  {
    return;  // told when they were read
  }
  double sum = 0.0;
  std::vector<std::vector<std::string>> together(1);
  for (const auto& [label, probability] : model.probabilities)
  {
    sum += probability;
    together.front().push_back(label);
  }
  if (std::abs(sum - 1.0) > kSumTolerance)
  {
    together.clear();
    for (const reasoner::CausalLaw& law : description_.causal_laws)
    {
      std::vector<std::string>& of_law = together.emplace_back();
      for (const reasoner::Outcome& outcome : law.outcomes)
      {
        if (law.action.name == action_.name && !outcome.label.empty())
        {
          of_law.push_back(outcome.label);
        }
      }
    }
  }
  for (const auto& [label, count] : model.counts)
  {
    std::optional<std::string> problem;
    for (const std::vector<std::string>& drawn : together)
    {
      if (std::find(drawn.begin(), drawn.end(), label) == drawn.end())
      {
        continue;
      }
      std::uint64_t total = 0;
      for (const std::string& other : drawn)
      {
        total += model.counts.at(other);
      }
      const double probability = model.probabilities.at(label);
      const auto expected = contradicted(probability, count, total, drawn.size(), model.prior);
      std::ostringstream message;
      message << what << ", " << label << ": probability " << probability
              << " contradicts its counts, " << count << " of " << total << "; expected about "
              << expected.value_or(0.0);
      problem = expected ? std::optional(message.str()) : std::nullopt;
      if (!problem)
      {
        break;
      }
    }
    if (problem)
    {
      file_.report(node, *problem);
    }
  }
}

}  // namespace kr3::refinement
