#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include <kr3_common/error.hpp>

#include "kr3_pomdp/pomdpx_format.hpp"

namespace kr3::pomdp
{

namespace
{

std::string exact(double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return text;
}

/// One element a line.
class Writer
{
public:
  Writer(std::ostream& out, const Model& model) : out_(out), model_(model)
  {
    for (const std::uint32_t label : model.initialLabels())
    {
      labels_.insert(label);
    }
  }

  void write()
  {
    out_ << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<pomdpx version=\"1.0\" id=\"model\">\n"
         << "<Discount>" << exact(model_.discount()) << "</Discount>\n";
    variables();
    initialBelief();
    transitions();
    observations();
    rewards();
    out_ << "</pomdpx>\n";
  }

private:
  [[nodiscard]] bool sees() const { return labels_.size() > 1; }

  template <typename NameOf>
  void values(std::size_t count, const NameOf& name_of)
  {
    out_ << "<ValueEnum>";
    for (std::size_t i = 0; i < count; ++i)
    {
      const std::string& name = name_of(i);
      if (name.find_first_of(" \t\r\n<>&*") != std::string::npos || name == "-")
      {
        throw InvalidArgument("the name '" + name +
                              "' cannot be written to a .pomdpx file, expected no blank, '<', "
                              "'>', '&' or '*'");
      }
      out_ << (i == 0 ? "" : " ") << name;
    }
    out_ << "</ValueEnum>";
  }

  void variables()
  {
    out_ << "<Variable>\n<StateVar vnamePrev=\"state_0\" vnameCurr=\"state_1\">";
    values(model_.numStates(),
           [this](std::size_t i) -> const std::string& { return model_.stateName(i); });
    out_ << "</StateVar>\n";
    if (sees())
    {
      // What is seen first; nothing afterwards.
      out_ << "<StateVar vnamePrev=\"seen_0\" vnameCurr=\"seen_1\" fullyObs=\"true\"><ValueEnum>";
      for (const std::uint32_t label : labels_)
      {
        out_ << "first" << label << ' ';
      }
      out_ << "later</ValueEnum></StateVar>\n";
    }
    out_ << "<ActionVar vname=\"action\">";
    values(model_.numActions(),
           [this](std::size_t i) -> const std::string& { return model_.actionName(i); });
    out_ << "</ActionVar>\n<ObsVar vname=\"observation\">";
    values(model_.numObservations(),
           [this](std::size_t i) -> const std::string& { return model_.observationName(i); });
    out_ << "</ObsVar>\n<RewardVar vname=\"reward\"/>\n</Variable>\n";
  }

  void open(const char* var, const char* parent, bool reward = false)
  {
    out_ << (reward ? "<Func>" : "<CondProb>") << "<Var>" << var << "</Var><Parent>" << parent
         << "</Parent><Parameter type=\"TBL\">\n";
  }
  void close(bool reward = false)
  {
    out_ << "</Parameter>" << (reward ? "</Func>\n" : "</CondProb>\n");
  }
  void entry(const std::string& instance, double value, bool reward = false)
  {
    out_ << "<Entry><Instance>" << instance << "</Instance>"
         << (reward ? "<ValueTable>" : "<ProbTable>") << exact(value)
         << (reward ? "</ValueTable>" : "</ProbTable>") << "</Entry>\n";
  }

  void initialBelief()
  {
    out_ << "<InitialStateBelief>\n";
    if (sees())
    {
      open("state_0 seen_0", "null");
    }
    else
    {
      open("state_0", "null");
    }
    for (std::size_t s = 0; s < model_.numStates(); ++s)
    {
      if (model_.initialBelief()[s] > 0.0)
      {
        const std::string seen =
            sees() ? " first" + std::to_string(model_.initialLabels()[s]) : std::string();
        entry(model_.stateName(s) + seen, model_.initialBelief()[s]);
      }
    }
    close();
    out_ << "</InitialStateBelief>\n";
  }

  void transitions()
  {
    out_ << "<StateTransitionFunction>\n";
    open("state_1", "action state_0");
    for (std::size_t a = 0; a < model_.numActions(); ++a)
    {
      for (std::size_t s = 0; s < model_.numStates(); ++s)
      {
        for (const SparseEntry& next : model_.transitions(a, s))
        {
          entry(
              model_.actionName(a) + " " + model_.stateName(s) + " " + model_.stateName(next.index),
              next.probability);
        }
      }
    }
    close();
    if (sees())
    {
      open("seen_1", "null");
      entry("later", 1.0);
      close();
    }
    out_ << "</StateTransitionFunction>\n";
  }

  void observations()
  {
    out_ << "<ObsFunction>\n";
    open("observation", "action state_1");
    for (std::size_t a = 0; a < model_.numActions(); ++a)
    {
      for (std::size_t s = 0; s < model_.numStates(); ++s)
      {
        for (const SparseEntry& seen : model_.observations(a, s))
        {
          entry(model_.actionName(a) + " " + model_.stateName(s) + " " +
                    model_.observationName(seen.index),
                seen.probability);
        }
      }
    }
    close();
    out_ << "</ObsFunction>\n";
  }

  void rewards()
  {
    out_ << "<RewardFunction>\n";
    open("reward", "action state_0", true);
    for (std::size_t a = 0; a < model_.numActions(); ++a)
    {
      for (std::size_t s = 0; s < model_.numStates(); ++s)
      {
        if (model_.reward(a, s) != 0.0)
        {
          entry(model_.actionName(a) + " " + model_.stateName(s), model_.reward(a, s), true);
        }
      }
    }
    close(true);
    out_ << "</RewardFunction>\n";
  }

  std::ostream& out_;
  const Model& model_;
  std::set<std::uint32_t> labels_;
};

}  // namespace

void writePomdpx(std::ostream& out, const Model& model)
{
  Writer(out, model).write();
}

}  // namespace kr3::pomdp
