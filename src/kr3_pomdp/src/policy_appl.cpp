// Policies as APPL's tools write and read them, see docs/pomdp_formats.md.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <istream>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <kr3_common/error.hpp>

#include "file_text.hpp"
#include "kr3_pomdp/policy_format.hpp"
#include "number_text.hpp"
#include "xml_text.hpp"

namespace kr3::pomdp
{

namespace
{

/// The states by what the robot sees of them, ascending.
std::vector<std::vector<std::uint32_t>> seenClasses(const Model& model)
{
  const std::vector<std::uint32_t>& labels = model.initialLabels();
  std::vector<std::vector<std::uint32_t>> classes(1);
  for (std::size_t s = 0; s < model.numStates(); ++s)
  {
    const std::size_t label = labels.empty() ? 0 : labels[s];
    if (label >= model.numStates())
    {
      throw InvalidArgument("label " + std::to_string(label) + " of state '" + model.stateName(s) +
                            "', expected labels numbered from 0");
    }
    classes.resize(std::max(classes.size(), label + 1));
    classes[label].push_back(static_cast<std::uint32_t>(s));
  }
  for (std::size_t label = 0; label < classes.size(); ++label)
  {
    if (classes[label].size() != classes.front().size())
    {
      throw InvalidArgument("the robot sees label " + std::to_string(label) + " in " +
                            std::to_string(classes[label].size()) + " states and label 0 in " +
                            std::to_string(classes.front().size()) +
                            "; APPL's format needs as many for each");
    }
  }
  return classes;
}

struct SeenVector
{
  std::size_t action;
  bool whole;  // made of a vector over all states
  std::vector<double> values;
};

/// Nowhere above another.
bool isDominated(const SeenVector& vector, const std::vector<SeenVector>& others)
{
  return std::any_of(others.begin(), others.end(), [&](const SeenVector& other) {
    return &other != &vector && other.values != vector.values &&
           std::equal(vector.values.begin(), vector.values.end(), other.values.begin(),
                      [](double a, double b) { return a <= b; });
  });
}

/// Below all that a policy earns or that any vector says.
double floorOf(const Policy& policy, const Model& model)
{
  double least = 0.0;
  for (std::size_t a = 0; a < model.numActions(); ++a)
  {
    least =
        std::min(least, *std::min_element(model.rewards(a), model.rewards(a) + model.numStates()));
  }
  // Without discount nothing bounds what is earned; the values are what is known.
  double floor = model.discount() < 1.0 ? least / (1.0 - model.discount()) : least;
  for (const AlphaVector& vector : policy.alphaVectors())
  {
    floor = std::min(floor, *std::min_element(vector.values.begin(), vector.values.end()));
  }
  return floor - 1.0;
}

/// From elements to a policy. Used once.
class ApplReader
{
public:
  ApplReader(std::string text, const std::string& name, const Model& model)
    : text_(std::move(text), name), model_(model), classes_(seenClasses(model))
  {
  }

  Policy read()
  {
    const pugi::xml_node root = text_.root();
    if (std::strcmp(root.name(), "Policy") != 0)
    {
      text_.fail(root, std::string("<") + root.name() + ">", "<Policy>");
    }
    const std::string type = root.attribute("type").as_string("value");
    if (type != "value")
    {
      text_.fail(root, "type '" + type + "'", "'value'");
    }
    const pugi::xml_node list = text_.child(root, "AlphaVector");
    declared(list, "vectorLength", classes_.front().size(),
             "states that the robot cannot tell apart");
    declared(list, "numObsValue", classes_.size(), "values of what the robot sees");
    std::size_t count = 0;
    for (const pugi::xml_node& child : list.children())
    {
      if (child.type() == pugi::node_element)
      {
        vector(child);
        ++count;
      }
    }
    if (count == 0)
    {
      text_.fail(list, "no vectors", "at least one");
    }
    if (list.attribute("numVectors"))
    {
      declared(list, "numVectors", count, "vectors in the file");
    }
    if (classes_.size() > 1)
    {
      const std::vector<double> last(model_.numStates(), least_ - 1.0);
      vectors_.push_back({vectors_.front().action, {}, last});
    }
    return Policy(model_.numStates(), vectors_);
  }

private:
  /// An attribute must say how many there are.
  void declared(const pugi::xml_node& element, const char* name, std::size_t expected,
                const std::string& what) const
  {
    const std::string text = text_.attribute(element, name);
    if (indexNumber(text) != expected)
    {
      text_.fail(element, std::string(name) + " '" + text + "'",
                 std::to_string(expected) + ", the number of " + what);
    }
  }

  void vector(const pugi::xml_node& element)
  {
    AlphaVector alpha;
    alpha.action = text_.index(element, "action", model_.numActions(), "actions");
    const std::size_t seen =
        text_.index(element, "obsValue", classes_.size(), "values of what the robot sees");
    if (classes_.size() > 1)
    {
      alpha.states = classes_[seen];
    }
    const std::string kind = element.name();
    if (kind == "Vector")
    {
      alpha.values = dense(element);
    }
    else if (kind == "SparseVector")
    {
      alpha.values = sparse(element);
    }
    else
    {
      text_.fail(element, "<" + kind + ">", "<Vector> or <SparseVector>");
    }
    least_ = std::min(least_, *std::min_element(alpha.values.begin(), alpha.values.end()));
    vectors_.push_back(std::move(alpha));
  }

  [[nodiscard]] std::vector<double> dense(const pugi::xml_node& element) const
  {
    const std::vector<XmlWord> words = XmlText::words(element);
    if (words.size() != classes_.front().size())
    {
      text_.fail(element, std::to_string(words.size()) + " values",
                 std::to_string(classes_.front().size()));
    }
    std::vector<double> values;
    values.reserve(words.size());
    for (const XmlWord& word : words)
    {
      values.push_back(text_.number(word));
    }
    return values;
  }

  [[nodiscard]] std::vector<double> sparse(const pugi::xml_node& element) const
  {
    std::vector<double> values(classes_.front().size(), 0.0);
    for (const pugi::xml_node& child : element.children())
    {
      const std::vector<XmlWord> words = XmlText::words(child);
      if (std::strcmp(child.name(), "Entry") != 0 || words.size() != 2)
      {
        text_.fail(
            child,
            std::string("<") + child.name() + "> of " + std::to_string(words.size()) + " words",
            "<Entry> with an index and a value");
      }
      const auto index = indexNumber(words[0].text);
      if (!index || *index >= values.size())
      {
        text_.fail(words[0], "an index below " + std::to_string(values.size()));
      }
      values[*index] = text_.number(words[1]);
    }
    return values;
  }

  XmlText text_;
  const Model& model_;
  std::vector<std::vector<std::uint32_t>> classes_;
  std::vector<AlphaVector> vectors_;
  double least_ = std::numeric_limits<double>::infinity();
};

/// The vectors that say something of each value of what the robot sees.
std::vector<std::vector<SeenVector>> bySeen(const Policy& policy, const Model& model)
{
  const std::vector<std::vector<std::uint32_t>> classes = seenClasses(model);
  struct Place
  {
    std::size_t seen;
    std::size_t index;
  };
  std::vector<Place> places(model.numStates());
  for (std::size_t seen = 0; seen < classes.size(); ++seen)
  {
    for (std::size_t i = 0; i < classes[seen].size(); ++i)
    {
      places[classes[seen][i]] = {seen, i};
    }
  }
  const double floor = floorOf(policy, model);
  std::vector<std::vector<SeenVector>> vectors(classes.size());
  std::vector<std::size_t> last(classes.size(), 0);  // the number of the vector put there last
  std::size_t number = 0;
  for (const AlphaVector& alpha : policy.alphaVectors())
  {
    ++number;
    for (std::size_t i = 0; i < alpha.values.size(); ++i)
    {
      const Place place = places[alpha.states.empty() ? i : alpha.states[i]];
      if (last[place.seen] != number)
      {
        last[place.seen] = number;
        vectors[place.seen].push_back({alpha.action, alpha.states.empty(),
                                       std::vector<double>(classes[place.seen].size(), floor)});
      }
      vectors[place.seen].back().values[place.index] = alpha.values[i];
    }
  }
  return vectors;
}

}  // namespace

void writeApplPolicy(std::ostream& out, const Policy& policy, const Model& model,
                     const std::string& model_name)
{
  checkFits(policy, model);
  std::vector<std::vector<SeenVector>> vectors = bySeen(policy, model);
  std::size_t count = 0;
  for (std::vector<SeenVector>& seen : vectors)
  {
    // A vector over all states, cut into one for each value, is mostly of use for one of them.
    std::vector<SeenVector> kept;
    for (const SeenVector& vector : seen)
    {
      if (vectors.size() == 1 || !vector.whole || !isDominated(vector, seen))
      {
        kept.push_back(vector);
      }
    }
    seen = std::move(kept);
    count += seen.size();
  }
  out << "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<Policy version=\"0.1\" type=\"value\" "
      << "model=\"" << xmlEscaped(model_name) << "\">\n<AlphaVector vectorLength=\""
      << model.numStates() / vectors.size() << "\" numObsValue=\"" << vectors.size()
      << "\" numVectors=\"" << count << "\">\n";
  for (std::size_t seen = 0; seen < vectors.size(); ++seen)
  {
    for (const SeenVector& vector : vectors[seen])
    {
      out << "<Vector action=\"" << vector.action << "\" obsValue=\"" << seen << "\">";
      for (const double value : vector.values)
      {
        out << exactText(value) << ' ';
      }
      out << "</Vector>\n";
    }
  }
  out << "</AlphaVector> </Policy>\n";
}

Policy readApplPolicy(std::istream& in, const std::string& name, const Model& model)
{
  return ApplReader(readAll(in, name), name, model).read();
}

}  // namespace kr3::pomdp
