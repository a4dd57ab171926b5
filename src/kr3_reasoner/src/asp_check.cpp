#include "asp_check.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <clingo.hh>

#include "diagnostics.hpp"

namespace kr3::reasoner
{

namespace
{

namespace ast = Clingo::AST;

/// Where a predicate of ours may stand in a block of a part.
struct Offered
{
  std::size_t arity;
  bool in_base;
  bool in_state;
  bool in_transition;
  bool may_be_derived;
  bool has_step;  ///< as its last argument
};

const std::map<std::string, Offered>& offered()
{
  static const std::map<std::string, Offered> kOffered = {
      {"sort", {2, true, true, true, false, false}},
      {"st", {2, true, true, true, true, false}},
      {"fv", {2, false, true, true, false, false}},
      {"agent", {1, false, true, true, false, false}},
      {"exog", {1, false, true, true, false, false}},
      {"h", {3, false, true, true, true, true}},
      {"occ", {2, false, false, true, false, true}},
  };
  return kOffered;
}

bool isOffered(const Offered& predicate, AspPart part)
{
  return part == AspPart::kBase    ? predicate.in_base
         : part == AspPart::kState ? predicate.in_state
                                   : predicate.in_transition;
}

std::vector<std::string> offeredNames(AspPart part)
{
  std::vector<std::string> names;
  for (const auto& [name, predicate] : offered())
  {
    if (isOffered(predicate, part))
    {
      names.push_back(name);
    }
  }
  return names;
}

bool isOwn(const std::string& name)
{
  return name.compare(0, 2, "x_") == 0;
}

/// Turns clingo's messages, `<block>:line:column: error: text` with further lines, into ours.
void translateMessages(const std::string& messages, const std::string& file,
                       std::vector<Diagnostic>& problems)
{
  static const std::regex kStart(R"(^<\w+>:(\d+):(\d+)[-:\d]*: (error|note|info): (.*)$)");
  std::istringstream lines(messages);
  bool started = false;
  for (std::string line; std::getline(lines, line);)
  {
    std::smatch parts;
    if (std::regex_match(line, parts, kStart) && parts[3] != "note")
    {
      problems.push_back(
          {{file, std::stoi(parts[1]), std::stoi(parts[2])}, "in asp code: " + parts[4].str()});
      started = true;
    }
    else if (started && !line.empty())
    {
      const std::string text = parts.empty() ? line : parts[4].str();
      problems.back().message += " " + text.substr(text.find_first_not_of(' ') == std::string::npos
                                                       ? 0
                                                       : text.find_first_not_of(' '));
    }
  }
}

/// The block at the lines it has in the file, so that clingo counts as people do.
std::string atItsLines(const AspBlock& block)
{
  return std::string(static_cast<std::size_t>(std::max(block.position.line - 1, 0)), '\n') +
         block.text;
}

/// The predicates of one description's blocks.
class BlockChecker
{
public:
  explicit BlockChecker(std::vector<Diagnostic>& problems) : problems_(problems) {}

  void check(const AspBlock& block)
  {
    block_ = &block;
    const std::size_t before = problems_.size();
    std::string messages;
    const auto log = [&](Clingo::WarningCode, const char* message) {
      messages.append(message).append("\n");
    };
    try
    {
      ast::parse_string(
          atItsLines(block).c_str(), [&](const ast::Node& statement) { visit(statement); }, log);
      if (problems_.size() == before)
      {
        Clingo::Control control({}, log);
        control.add("part", {"t"}, atItsLines(block).c_str());
        control.ground({{"base", {}}});  // nothing; but it checks the safety of the part
      }
    }
    catch (const std::exception& e)
    {
      translateMessages(messages, block.position.file, problems_);
      if (problems_.size() == before)
      {
        problems_.push_back({block.position, "in asp code: " + std::string(e.what())});
      }
    }
  }

  /// After all blocks: own predicates that none defines.
  void finish()
  {
    std::vector<std::string> names;
    for (const auto& [name, part] : defined_)
    {
      names.push_back(name);
    }
    for (const Use& use : used_)
    {
      const auto found = defined_.find(use.signature);
      if (found == defined_.end())
      {
        problems_.push_back({use.position, "in asp code: nothing defines " + use.signature +
                                               suggestion(use.signature, names)});
      }
      else if (found->second != AspPart::kBase && (found->second != use.part || use.last != "t"))
      {
        problems_.push_back(
            {use.position, "in asp code: found " + use.signature +
                               ", expected it at t and in the part where it is derived: only "
                               "fluents last from step to step"});
      }
    }
  }

private:
  [[nodiscard]] SourcePosition position(const ast::Node& node) const
  {
    const auto location = node.get<Clingo::Location>(ast::Attribute::Location);
    return {block_->position.file, static_cast<int>(location.begin_line()),
            static_cast<int>(location.begin_column())};
  }

  void report(const ast::Node& node, const std::string& message)
  {
    problems_.push_back({position(node), "in asp code: " + message});
  }

  void visit(const ast::Node& statement)
  {
    switch (statement.type())
    {
      case ast::Type::Rule:
        visitHead(statement.get<ast::Node>(ast::Attribute::Head));
        for (const ast::Node& part : statement.get<ast::NodeVector>(ast::Attribute::Body))
        {
          visitAtoms(part, false);
        }
        break;
      case ast::Type::Comment:
        break;
      case ast::Type::Program:  // clingo's own, before the first statement
        if (std::string(statement.get<const char*>(ast::Attribute::Name)) != "base" ||
            position(statement).line > 1)
        {
          report(statement, "found #program, expected rules and constraints only");
        }
        break;
      default:
        report(statement, "found a directive, expected rules and constraints only");
    }
  }

  void visitHead(const ast::Node& head)
  {
    const auto visitor = [&](const ast::Node& node) {
      if (node.type() == ast::Type::ConditionalLiteral)
      {
        visitAtoms(node.get<ast::Node>(ast::Attribute::Literal), true);
        for (const ast::Node& part : node.get<ast::NodeVector>(ast::Attribute::Condition))
        {
          visitAtoms(part, false);
        }
        return false;
      }
      if (node.type() == ast::Type::TheoryAtom)
      {
        report(node, "found a theory atom, expected a predicate");
        return false;
      }
      if (node.type() == ast::Type::SymbolicAtom)
      {
        visitAtom(node, true);
        return false;
      }
      return true;
    };
    head.visit_ast(visitor);
  }

  void visitAtoms(const ast::Node& part, bool derived)
  {
    const auto visitor = [&](const ast::Node& node) {
      if (node.type() == ast::Type::TheoryAtom)
      {
        report(node, "found a theory atom, expected a predicate");
        return false;
      }
      if (node.type() == ast::Type::SymbolicAtom)
      {
        visitAtom(node, derived);
        return false;
      }
      return true;
    };
    part.visit_ast(visitor);
  }

  void visitAtom(const ast::Node& atom, bool derived)
  {
    const auto function = atom.get<ast::Node>(ast::Attribute::Symbol);
    if (function.type() != ast::Type::Function)
    {
      report(function, "found " + function.to_string() + ", expected a predicate without '-'");
      return;
    }
    const std::string name = function.get<const char*>(ast::Attribute::Name);
    const auto arguments = function.get<ast::NodeVector>(ast::Attribute::Arguments);
    const std::string last = arguments.empty() ? "" : ast::Node(*(arguments.end() - 1)).to_string();
    const std::string signature = name + "/" + std::to_string(arguments.size());
    if (isOwn(name))
    {
      useOwn(function, signature, last, derived);
      return;
    }
    const auto found = offered().find(name);
    if (found == offered().end() || !isOffered(found->second, block_->part))
    {
      report(function, "unknown predicate '" + name + "'" +
                           suggestion(name, offeredNames(block_->part)) +
                           " (a predicate of your own begins with x_)");
    }
    else if (found->second.arity != arguments.size())
    {
      report(function, "found " + std::to_string(arguments.size()) + " arguments of " + name +
                           ", expected " + std::to_string(found->second.arity));
    }
    else if (derived && !found->second.may_be_derived)
    {
      report(function, "found " + name + " in a head, expected h or a predicate of your own");
    }
    else if (found->second.has_step)
    {
      checkStep(function, name, last, derived);
    }
  }

  /// What is derived at a step stays in its part: only fluents last from step to step.
  void useOwn(const ast::Node& function, const std::string& signature, const std::string& last,
              bool derived)
  {
    const bool at_step = block_->part != AspPart::kBase;
    if (derived && at_step && last != "t")
    {
      report(function, "found " + function.to_string() +
                           ", expected t as the last argument of what is derived at each step");
    }
    if (!derived)
    {
      used_.push_back({signature, position(function), block_->part, last});
    }
    else if (!defined_.emplace(signature, block_->part).second &&
             defined_.at(signature) != block_->part)
    {
      report(function, "found " + signature + " in the heads of two parts, expected one");
    }
  }

  void checkStep(const ast::Node& function, const std::string& name, const std::string& step,
                 bool derived)
  {
    const bool now = step == "t" && name == "h";
    const bool before = (step == "t-1" || step == "(t-1)") && block_->part == AspPart::kTransition;
    if (!(now || (before && !(derived && name == "h"))))
    {
      report(function, "found the step " + step + " of " + name + ", expected " +
                           (block_->part == AspPart::kState ? "t"
                            : name != "h"                   ? "t-1"
                            : derived                       ? "t"
                                                            : "t or t-1"));
    }
  }

  std::vector<Diagnostic>& problems_;
  const AspBlock* block_ = nullptr;
  struct Use
  {
    std::string signature;
    SourcePosition position;
    AspPart part;
    std::string last;  // its last argument
  };

  std::map<std::string, AspPart> defined_;
  std::vector<Use> used_;
};

}  // namespace

void checkAsp(const Description& description, std::vector<Diagnostic>& problems)
{
  BlockChecker checker(problems);
  for (const AspBlock& block : description.asp_blocks)
  {
    checker.check(block);
  }
  checker.finish();
}

}  // namespace kr3::reasoner
