#include <ostream>

#include <kr3_common/error.hpp>

#include "number_text.hpp"
#include "pomdpx_writer.hpp"
#include "xml_text.hpp"

namespace kr3::pomdp
{

namespace
{

std::string joined(const std::vector<std::string>& names)
{
  std::string text;
  for (const std::string& name : names)
  {
    text += (text.empty() ? "" : " ") + name;
  }
  return text;
}

}  // namespace

PomdpxElements::PomdpxElements(std::ostream& out, double discount) : out_(out)
{
  out_ << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<pomdpx version=\"1.0\" id=\"model\">\n"
       << "<Discount>" << exactText(discount) << "</Discount>\n";
}

void PomdpxElements::open(const char* section)
{
  out_ << '<' << section << ">\n";
}

void PomdpxElements::close(const char* section)
{
  out_ << "</" << section << ">\n";
}

void PomdpxElements::end()
{
  close("pomdpx");
}

void PomdpxElements::values(const std::vector<std::string>& values)
{
  out_ << "<ValueEnum>" << joined(values) << "</ValueEnum>";
}

void PomdpxElements::stateVariable(const std::string& previous, const std::string& current,
                                   bool observed, const std::vector<std::string>& values)
{
  out_ << "<StateVar vnamePrev=\"" << previous << "\" vnameCurr=\"" << current << "\" fullyObs=\""
       << (observed ? "true" : "false") << "\">";
  this->values(values);
  out_ << "</StateVar>\n";
}

void PomdpxElements::variable(const char* kind, const std::string& name,
                              const std::vector<std::string>& values)
{
  out_ << '<' << kind << " vname=\"" << name << "\">";
  this->values(values);
  out_ << "</" << kind << ">\n";
}

void PomdpxElements::rewardVariable(const std::string& name)
{
  out_ << "<RewardVar vname=\"" << name << "\"/>\n";
}

void PomdpxElements::openTable(bool reward, const std::vector<std::string>& of,
                               const std::vector<std::string>& parents)
{
  reward_ = reward;
  out_ << (reward ? "<Func>" : "<CondProb>") << "<Var>" << joined(of) << "</Var><Parent>"
       << (parents.empty() ? "null" : joined(parents)) << "</Parent><Parameter type=\"TBL\">\n";
}

void PomdpxElements::entry(const std::string& instance, const std::vector<double>& numbers)
{
  const char* const table = reward_ ? "ValueTable>" : "ProbTable>";
  out_ << "<Entry><Instance>" << instance << "</Instance><" << table;
  for (std::size_t i = 0; i < numbers.size(); ++i)
  {
    out_ << (i == 0 ? "" : " ") << exactText(numbers[i]);
  }
  out_ << "</" << table << "</Entry>\n";
}

void PomdpxElements::closeTable()
{
  out_ << "</Parameter>" << (reward_ ? "</Func>\n" : "</CondProb>\n");
}

std::vector<std::string> pomdpxNames(const std::vector<std::string>& names)
{
  std::vector<std::string> escaped;
  escaped.reserve(names.size());
  for (const std::string& name : names)
  {
    if (name.find_first_of(" \t\r\n") != std::string::npos || name.empty() || name == "-" ||
        name == "*" || name == "null")
    {
      throw InvalidArgument("the name '" + name +
                            "' cannot be written to a .pomdpx file, expected no blank, and not "
                            "'-', '*' or 'null' alone");
    }
    escaped.push_back(xmlEscaped(name));
  }
  return escaped;
}

}  // namespace kr3::pomdp
