#include "text_output.hpp"

#include <functional>
#include <map>
#include <sstream>

namespace kr3::reasoner::tool
{

namespace
{

/// `1 plan`, `2 plans`.
std::string counted(std::size_t count, const std::string& noun)
{
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string joined(const Json& items, const std::string& separator)
{
  std::string text;
  for (const Json& item : items)
  {
    text += (text.empty() ? "" : separator) + item.get<std::string>();
  }
  return text;
}

/// Items after one another in lines of at most 100 characters.
std::string wrapped(const Json& items, const std::string& indent)
{
  constexpr std::size_t kWidth = 100;
  std::string text;
  std::string line = indent;
  for (std::size_t i = 0; i < items.size(); ++i)
  {
    const std::string item = items[i].get<std::string>() + (i + 1 < items.size() ? "," : "");
    if (line.size() > indent.size() && line.size() + 1 + item.size() > kWidth)
    {
      text += line + "\n";
      line = indent;
    }
    line += (line.size() == indent.size() ? "" : " ") + item;
  }
  return text + (line.size() == indent.size() ? "" : line + "\n");
}

std::string recordLines(const Json& records)
{
  std::string text;
  for (const Json& record : records)
  {
    text += "  " + record["record"].get<std::string>();
    if (record["file"].is_string())
    {
      text += "   (" + record["file"].get<std::string>() + ":" + record["line"].dump() + ")";
    }
    text += "\n";
  }
  return text;
}

std::string checkText(const Json& answer)
{
  std::string text = joined(answer["files"], ", ") + ": no errors\n";
  for (const auto& [key, value] : answer.items())
  {
    if (value.is_number() && value != 0)
    {
      std::string name = key;
      name.resize(14, ' ');
      text += "  " + name + value.dump() + "\n";
    }
  }
  return text;
}

std::string entailsText(const Json& answer)
{
  const std::string step = " at step " + answer["step"].dump();
  if (answer.contains("literals"))
  {
    return "Entailed" + step + ":\n" + wrapped(answer["literals"], "  ");
  }
  const std::string verdict = answer["answer"].get<std::string>();
  return answer["literal"].get<std::string>() + step + ": " + verdict +
         (verdict == "unknown" ? " (possible, not certain)" : "") + "\n";
}

std::string explainText(const Json& answer)
{
  const std::string what =
      answer["literal"].get<std::string>() + " at step " + answer["step"].dump();
  if (answer["answer"] != "true")
  {
    return what + " is " +
           (answer["answer"] == "false" ? "false" : "unknown: it may hold and it may not") + ".\n";
  }
  std::string text = what + " holds:\n";
  for (const Json& reason : answer["reasons"])
  {
    text += "  - " + reason.get<std::string>() + "\n";
  }
  return text + (answer["records"].empty() ? "It rests on no record.\n"
                                           : "It rests on:\n" + recordLines(answer["records"]));
}

std::string modelsText(const Json& answer)
{
  const Json& models = answer["models"];
  std::string text;
  for (std::size_t i = 0; i < models.size(); ++i)
  {
    const Json& model = models[i];
    text += (i == 0 ? "" : "\n") + std::string("Model ") + std::to_string(i + 1);
    text += model["assumed"].empty() ? "\n" : ", assuming " + joined(model["assumed"], "; ") + "\n";
    for (std::size_t step = 0; step < model["states"].size(); ++step)
    {
      const std::size_t number = step + model["first_step"].get<std::size_t>();
      text += "  step " + std::to_string(number) + "\n" + wrapped(model["states"][step], "    ");
      if (step < model["actions"].size() && !model["actions"][step].empty())
      {
        text += "  > " + joined(model["actions"][step], ", ") + "\n";
      }
    }
  }
  return text + (answer["complete"].get<bool>() ? "\n" + counted(models.size(), "model") + "\n"
                                                : "\nOnly " + counted(models.size(), "model") +
                                                      " of more (--limit N, --all)\n");
}

std::string explanationLines(const Json& answer, const std::string& price)
{
  const Json& explanations = answer["explanations"];
  const bool complete = answer["complete"].get<bool>();
  std::string text = (complete ? "" : "the first ") + counted(explanations.size(), "explanation") +
                     (complete ? "" : " of more") + " at the minimal price of " + price + ":\n";
  for (std::size_t i = 0; i < explanations.size(); ++i)
  {
    text += "  " + std::to_string(i + 1) + ". " + explanations[i]["in_words"].get<std::string>() +
            "\n     " + joined(explanations[i]["statements"], "; ") + "\n";
  }
  return text;
}

std::string diagnoseText(const Json& answer)
{
  if (!answer["consistent"].get<bool>())
  {
    return "The history is inconsistent. These records cannot all be right:\n" +
           recordLines(answer["conflict"]);
  }
  if (answer["cost"] == 0)
  {
    return "Nothing unexpected: the history needs no explanation.\n";
  }
  const std::string price = answer["cost"].dump();
  if (answer["parts"].size() < 2 || answer["explanations"].size() == 1)
  {
    return explanationLines(answer, price);
  }
  const Json& parts = answer["parts"];
  std::string text =
      std::to_string(parts.size()) +
      " parts that do not hang together, one explanation of each at the minimal price of " + price +
      " in all.\n";
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    const Json& part = parts[i];
    text += "Part " + std::to_string(i + 1) + ": " + explanationLines(part, part["price"].dump());
  }
  return text;
}

std::string numberText(const Json& number)
{
  std::ostringstream text;
  text << number.get<double>();
  return text.str();
}

/// `12 of 40 fluents`.
std::string shareText(const Json& answer, const char* what)
{
  return answer["considered"][what].dump() + " of " + answer["whole"][what].dump() + " " + what;
}

std::string relevantText(const Json& answer)
{
  std::string text = "What can matter to " + answer["goal"].get<std::string>() + ": " +
                     shareText(answer, "fluents") + ", " + shareText(answer, "constants") + ", " +
                     shareText(answer, "actions") + ", " + shareText(answer, "records") + "\n";
  for (const char* kind : {"constants", "fluents", "actions"})
  {
    Json names = Json::array();
    for (const Json& item : answer[kind])
    {
      names.push_back(item["name"]);
    }
    text += std::string(kind) + "\n" + wrapped(names, "  ");
  }
  return text + (answer["records"].empty() ? "" : "records\n" + recordLines(answer["records"]));
}

std::string planText(const Json& answer)
{
  if (answer["goal_entailed"].get<bool>())
  {
    return "Nothing to do: the goal holds already.\n";
  }
  const Json& plans = answer["plans"];
  if (plans.empty())
  {
    return "No plan: " + answer["reason"].get<std::string>() + "\n";
  }
  std::string text;
  for (std::size_t i = 0; i < plans.size(); ++i)
  {
    const Json& plan = plans[i];
    text += (i == 0 ? "" : "\n") + std::string("Plan");
    text += plans.size() == 1 ? ""
                              : " " + std::to_string(i + 1) + " of " + std::to_string(plans.size());
    text += ", " + counted(plan["steps"].size(), "step") + ", cost " + numberText(plan["cost"]);
    text +=
        plan["hypothesis"].empty() ? "\n" : ", if " + joined(plan["hypothesis"], " and ") + "\n";
    std::size_t step = answer["first_step"].get<std::size_t>();
    for (const Json& actions : plan["steps"])
    {
      text += "  step " + std::to_string(step++) + ": " + joined(actions, ", ") + "\n";
    }
  }
  return text + (answer["complete"].get<bool>()
                     ? ""
                     : "\nThere are more plans as good as these (--max-plans N)\n");
}

std::string importedText(const Arguments& arguments, const Json& answer)
{
  if (arguments.part != "goals")
  {
    return answer[arguments.part].get<std::string>();
  }
  std::string text;
  for (const Json& goal : answer["goals"])
  {
    text += goal.get<std::string>() + "\n";
  }
  return text;
}

}  // namespace

std::string textOf(const Arguments& arguments, const Json& answer)
{
  if (arguments.command == "import-sparc")
  {
    return importedText(arguments, answer);
  }
  static const std::map<std::string, std::function<std::string(const Json&)>> kWriters = {
      {"check", checkText},
      {"entails", entailsText},
      {"explain", explainText},
      {"models", modelsText},
      {"diagnose", diagnoseText},
      {"plan", planText},
      {"relevant", relevantText},
      {"translate", [](const Json& a) { return a["program"].get<std::string>(); }},
  };
  return kWriters.at(arguments.command)(answer);
}

}  // namespace kr3::reasoner::tool
