#pragma once

#include <cstddef>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "kr3_reasoner/explanation.hpp"
#include "kr3_reasoner/language.hpp"

namespace kr3::reasoner
{

/// "law" of what rests on none that could be taken away.
constexpr std::size_t kNoLaw = std::numeric_limits<std::size_t>::max();

/// The laws of a description that an explanation may cite, by number: causal laws, state
/// constraints, executability conditions of one action, and of each defined fluent all of its
/// rules together. Rules for statics and conditions on several actions always stay. Private to the
/// package.
class Laws
{
public:
  explicit Laws(const Description& description);

  [[nodiscard]] std::size_t size() const { return laws_.size(); }
  [[nodiscard]] const CitedLaw& law(std::size_t number) const { return laws_[number]; }

  /// By index in the description; kNoLaw: it always stays.
  [[nodiscard]] std::size_t ofCausalLaw(std::size_t index) const { return causal_[index]; }
  [[nodiscard]] std::size_t ofConstraint(std::size_t index) const { return constraints_[index]; }
  [[nodiscard]] std::size_t ofExecutability(std::size_t index) const
  {
    return executabilities_[index];
  }
  /// Of a defined fluent that has rules.
  [[nodiscard]] std::size_t ofDefinition(const std::string& fluent) const;

private:
  std::size_t add(LawKind kind, const std::string& about, const SourcePosition& position);

  std::vector<CitedLaw> laws_;
  std::vector<std::size_t> causal_;
  std::vector<std::size_t> constraints_;
  std::vector<std::size_t> executabilities_;
};

/// What is left of a history and its description, or cited by an explanation.
struct Cited
{
  std::set<std::size_t> records;
  std::set<std::string> defaults;  ///< ground
  std::set<std::size_t> laws;
  bool every_default = false;  ///< whatever they are called

  void insert(const Cited& other);
  [[nodiscard]] bool hasDefault(const std::string& name) const
  {
    return every_default || defaults.count(name) > 0;
  }
  [[nodiscard]] bool hasLaw(std::size_t law) const { return law == kNoLaw || laws.count(law) > 0; }
};

[[nodiscard]] bool operator==(const Cited& a, const Cited& b);

/// One of the things cited.
struct CitedItem
{
  enum class Kind
  {
    kRecord,
    kDefault,
    kLaw
  };
  Kind kind = Kind::kRecord;
  std::size_t number = 0;  ///< of a record or law
  std::string name;        ///< of a default
};

/// Records first, then defaults, then laws.
[[nodiscard]] std::vector<CitedItem> itemsOf(const Cited& cited);
[[nodiscard]] Cited citedOf(const std::vector<CitedItem>& items);

}  // namespace kr3::reasoner
