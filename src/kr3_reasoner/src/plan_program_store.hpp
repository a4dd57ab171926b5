#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <string>

namespace kr3::reasoner
{

class PlanProgram;

/// Plan programs that start from any state, so that what was grounded for a goal stays grounded
/// while the state changes: the horizon only grows. Private to the package.
class PlanProgramStore
{
public:
  PlanProgramStore();
  ~PlanProgramStore();

  /// Whether a goal was asked for before; then a program for it is worth keeping. Remembers it.
  [[nodiscard]] bool isAskedAgain(const std::string& key);

  /// The program that was kept; nullptr when there is none.
  [[nodiscard]] std::unique_ptr<PlanProgram> take(const std::string& key);
  void keep(const std::string& key, std::unique_ptr<PlanProgram> program);

private:
  struct Entry
  {
    std::string key;
    std::unique_ptr<PlanProgram> program;  ///< or nullptr, while it is taken and before it is made
  };
  static constexpr std::size_t kMost = 4;

  std::list<Entry>::iterator find(const std::string& key);

  std::list<Entry> entries_;  // the one used last comes first
};

}  // namespace kr3::reasoner
