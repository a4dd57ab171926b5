#include "translation.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <utility>

namespace kr3::reasoner
{

namespace
{

const char* const kLegend =
    R"(%   h(F,V,T)   the fluent F has the value V at step T (a defined fluent: V is true)
%   occ(A,T)   the action A occurs between the steps T and T+1
%   assumed(X) X explains: no(F,V), yes(F,V) against a default; exo(A,T), an exogenous action;
%              fail(A,T), a failed attempt; wrong(R), the record number R
)";

const char* const kAssumedRules = R"(
assumed(_X) :- ab(_X), weight(_X,_).
assumed(_X) :- ab(_X), doubt(_X,_).
)";

const char* const kPlanRules = R"(
% ---- The plan: something is done at each step from now on, and the goal holds at the end. ----
{ occ(_A,_Step-1) : agent(_A) } :- future(_Step).
busy(_Step) :- occ(_A,_Step), agent(_A).
:- future(_Step), not busy(_Step-1).
)";

bool inWord(char c)
{
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Copies a program token by token: words, and single characters between them; comments and strings
/// whole.
class Rewriter
{
public:
  Rewriter(const std::string& text, std::map<std::string, std::string> words)
    : text_(text), words_(std::move(words))
  {
  }

  /// @param finish  gets each statement without its dot, and whether a word was replaced in it
  std::string run(const std::function<std::string(const std::string&, bool)>& finish)
  {
    std::string result;
    std::string statement;
    bool replaced = false;
    for (std::size_t i = 0; i < text_.size();)
    {
      std::size_t end = i + 1;
      if (text_[i] == '%')
      {
        end = std::min(text_.find('\n', i), text_.size());
        (isBlank(statement) ? result : statement) += text_.substr(i, end - i);
      }
      else if (text_[i] == '"')
      {
        end = std::min(text_.find('"', i + 1), text_.size() - 1) + 1;
        statement += text_.substr(i, end - i);
      }
      else if (inWord(text_[i]))
      {
        while (end < text_.size() && inWord(text_[end]))
        {
          ++end;
        }
        const std::string word = text_.substr(i, end - i);
        const auto found = words_.find(word);
        replaced = replaced || found != words_.end();
        statement += found == words_.end() ? word : found->second;
      }
      else if (text_.compare(i, 2, "..") == 0)
      {
        end = i + 2;
        statement += "..";
      }
      else if (text_[i] == '.')
      {
        result += finish(statement, replaced);
        statement.clear();
        replaced = false;
      }
      else if (isBlank(statement) && text_[i] == '\n')
      {
        result += text_[i];
      }
      else
      {
        statement += text_[i];
      }
      i = end;
    }
    return result + statement;
  }

private:
  static bool isBlank(const std::string& text)
  {
    return text.find_first_not_of(" \t\n") == std::string::npos;
  }

  const std::string& text_;
  std::map<std::string, std::string> words_;
};

/// The text of a program, by the name of the part.
std::map<std::string, std::string> partsOf(const std::string& program)
{
  const std::string mark = "#program ";
  std::map<std::string, std::string> parts;
  for (std::size_t start = program.find(mark); start != std::string::npos;)
  {
    const std::size_t next = program.find("\n" + mark, start);
    const std::size_t name = start + mark.size();
    const std::size_t name_end = program.find_first_of("(.", name);
    const std::size_t text = program.find('\n', name_end) + 1;
    parts[program.substr(name, name_end - name)] +=
        program.substr(text, next == std::string::npos ? std::string::npos : next + 1 - text);
    start = next == std::string::npos ? next : next + 1;
  }
  return parts;
}

std::string withoutShow(const std::string& rules)
{
  return Rewriter(rules, {}).run([](const std::string& statement, bool) {
    return statement.find("#show") == std::string::npos ? statement + "." : "";
  });
}

class GoalRules
{
public:
  GoalRules(const Description& description, std::string step)
    : description_(description), encoding_(description), step_(std::move(step))
  {
  }

  /// The atom that stands for a formula; its rules are added to text().
  std::string add(const Formula& formula)
  {
    const std::string name = "goal(" + std::to_string(num_parts_++) + ")";
    if (formula.kind == Formula::Kind::kLiteral)
    {
      text_ += name + " :- " + encoding_.literal(normalized(formula.literal, description_), step_) +
               ".\n";
      return name;
    }
    std::string conjunction;
    for (const Formula& operand : formula.operands)
    {
      const std::string part = add(operand);
      if (formula.kind == Formula::Kind::kOr)
      {
        text_ += name + " :- " + part + ".\n";
      }
      conjunction += (conjunction.empty() ? "" : ", ") +
                     std::string(formula.kind == Formula::Kind::kNot ? "not " : "") + part;
    }
    if (formula.kind != Formula::Kind::kOr)
    {
      text_ += name + " :- " + conjunction + ".\n";
    }
    return name;
  }

  [[nodiscard]] const std::string& text() const { return text_; }

private:
  const Description& description_;
  Encoding encoding_;
  std::string step_;
  std::string text_;
  int num_parts_ = 0;
};

std::string header(int first_step, int current_step, const Optimum& optimum,
                   const TranslatedGoal* goal)
{
  std::string text = goal == nullptr
                         ? "% A description with a history, as an answer set program. Each answer "
                           "set is a model.\n"
                         : "% A description with a history and a goal, as an answer set program. "
                           "Each answer set is a\n% trajectory on which a plan reaches the goal: " +
                               toString(goal->formula) + "\n";
  text += "% All of them: clingo --project=show FILE 0\n" + std::string(kLegend);
  text += "\n#const _now = " + std::to_string(current_step) + ".   % the current step\n";
  text += "#const _last = _now + " + std::to_string(goal == nullptr ? 0 : goal->length) +
          ".   % the last step\n";
  const std::string first = std::to_string(first_step);
  const std::string next = std::to_string(first_step + 1);
  text += "time(" + first + ".._last). transition(" + next + ".._last). past(" + next + ".._now).";
  text += goal == nullptr ? "\n" : " future(_now+1.._last).\n";
  text += "#const _price = " + std::to_string(optimum.price.total().assumptions) +
          ".     % minimal price of what is assumed\n";
  text += "#const _doubts = " + std::to_string(optimum.price.total().retractions) +
          ".    % and of the records that are taken to be wrong\n";
  return text;
}

}  // namespace

std::string overAllSteps(const std::string& rules, const std::string& parameter,
                         const std::string& range)
{
  return Rewriter(rules, {{parameter, "_Step"}})
      .run([&](const std::string& statement, bool replaced) {
        if (!replaced || statement.find('#') == statement.find_first_not_of(" \n"))
        {
          return statement + ".";
        }
        const bool has_body = statement.find(":-") != std::string::npos;
        return statement + (has_body ? "; " : " :- ") + range + "(_Step).";
      });
}

std::string translationOf(const Description& description, const HistoryProgram& program,
                          const std::vector<CheckedRecord>& records, int current_step,
                          const Optimum& optimum, const TranslatedGoal* goal)
{
  std::map<std::string, std::string> parts = partsOf(program.text(records, optimum.assumable));
  std::string text = header(program.firstStep(), current_step, optimum, goal);
  text += "\n% ---- Sorts, fluents and actions; what is known initially ----\n" +
          withoutShow(parts["base"]);
  text += "\n% ---- Every state ----\n" + overAllSteps(parts["state"], "_t", "time");
  text += "\n% ---- Every transition, to a step from the one before ----\n" +
          overAllSteps(parts["trans"], "_t", "transition");
  text += "\n% ---- The history ----\n" + parts["records"];
  if (optimum.assumable.exogenous)
  {
    text += "\n% ---- Exogenous actions that may be assumed ----\n" +
            overAllSteps(parts["exo"], "_t", "past");
  }
  text +=
      "\n% ---- No more is assumed than it takes. Without these two, the minimum itself is "
      "found by:\n" +
      Rewriter(parts["minimize"], {}).run([](const std::string& statement, bool) {
        return "% " + statement + ".";
      });
  text += Rewriter(parts["bound"], {{"r", "_doubts"}, {"a", "_price"}})
              .run([](const std::string& statement, bool) { return statement + "."; });
  text += kAssumedRules;
  if (goal != nullptr)
  {
    GoalRules rules(description, "_last");
    const std::string root = rules.add(goal->formula);
    text += kPlanRules + rules.text() + ":- not " + root + ".\n";
  }
  return text + "\n#show h/3.\n#show occ/2.\n#show assumed/1.\n";
}

}  // namespace kr3::reasoner
