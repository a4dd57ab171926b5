#include "oracle.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <kr3_common/error.hpp>

namespace kr3::reasoner::oracle
{

namespace
{

constexpr std::size_t kMaxAssignments = 2000;
constexpr std::size_t kMaxHeads = 9;
constexpr std::size_t kMaxModels = 20000;

struct GroundRecord
{
  Record record;
  std::optional<GroundLiteral> literal;  ///< of an observation
  bool impossible = false;               ///< an observation of a static that is not so
  int action = -1;
  int doubt = 0;  ///< price of retracting it
};

/// An exception that may be assumed: the contrary of a head.
struct Exception
{
  GroundLiteral literal;
  std::string statement;
  int price = 0;
};

class HistorySearch
{
public:
  HistorySearch(const Description& description, const std::vector<Record>& records,
                const ReasonerOptions& options)
    : domain_(grounded(description)), diagram_(domain_, kMaxAssignments), options_(options)
  {
    readRecords(description, records);
    collectExceptions();
  }

  Answers run()
  {
    const bool uncertain = std::any_of(records_.begin(), records_.end(),
                                       [](const GroundRecord& each) { return each.doubt > 0; });
    std::vector<std::pair<bool, bool>> levels = {{options_.diagnose_exogenous, false}};
    levels.emplace_back(true, false);
    if (uncertain)
    {
      levels.emplace_back(options_.diagnose_exogenous, true);
      levels.emplace_back(true, true);
    }
    for (const auto& [exogenous, retractions] : levels)
    {
      exogenous_ = exogenous;
      models_.clear();
      tryRetractions(0, retractions, 0, {});
      if (!models_.empty())
      {
        return {true, best_.first + best_.second, models_};
      }
    }
    return {};
  }

private:
  void readRecords(const Description& description, const std::vector<Record>& records)
  {
    for (const Record& record : records)
    {
      GroundRecord ground{record, std::nullopt, false, -1, 0};
      const bool is_action =
          record.kind == RecordKind::kHappened || record.kind == RecordKind::kAttempted;
      last_ = std::max(last_, record.step + (is_action ? 1 : 0));
      if (is_action)
      {
        ground.action = actionOf(record.statement, domain_);
      }
      else
      {
        const Literal literal = parseGroundLiteral(record.statement, description);
        ground.literal = literalOf(literal, domain_);
        ground.impossible =
            !ground.literal && staticHolds(literal, description, domain_) != record.value;
        if (ground.literal && !record.value)
        {
          ground.literal = contrary(*ground.literal, domain_);
        }
        if (record.confidence < 1.0)
        {
          const double odds = record.confidence / (1.0 - record.confidence);
          ground.doubt = static_cast<int>(std::max(1L, std::lround(100.0 * std::log(odds))));
        }
      }
      records_.push_back(ground);
    }
  }

  void collectExceptions()
  {
    for (const GroundDefault& rule : domain_.defaults)
    {
      const auto weight = options_.default_weights.find(rule.name);
      const int price =
          weight == options_.default_weights.end() ? options_.exception_weight : weight->second;
      const GroundFluentInfo& fluent = domain_.fluents[static_cast<std::size_t>(rule.head.fluent)];
      const bool negative = fluent.boolean ? rule.head.value == 0 : !rule.head.equal;
      const std::string statement =
          "init(" + fluent.name +
          (fluent.boolean ? "" : " = " + fluent.values[static_cast<std::size_t>(rule.head.value)]) +
          (negative ? ", true)" : ", false)");
      const auto known = std::find_if(exceptions_.begin(), exceptions_.end(),
                                      [&](const Exception& e) { return e.statement == statement; });
      if (known != exceptions_.end())
      {
        known->price = std::min(known->price, price);
      }
      else
      {
        exceptions_.push_back({contrary(rule.head, domain_), statement, price});
      }
    }
    if (exceptions_.size() > kMaxHeads)
    {
      throw ResourceExhausted("too many exceptions to enumerate");
    }
  }

  // ---- What is assumed ----

  [[nodiscard]] bool tooDear(int doubt, int price) const
  {
    return !models_.empty() && std::pair(doubt, price) > best_;
  }

  void tryRetractions(std::size_t next, bool allowed, int doubt, std::set<std::size_t> wrong)
  {
    if (tooDear(doubt, 0))
    {
      return;
    }
    if (next == records_.size())
    {
      doubt_ = doubt;
      wrong_ = std::move(wrong);
      tryExceptions(0, 0, {});
      return;
    }
    tryRetractions(next + 1, allowed, doubt, wrong);
    if (allowed && records_[next].doubt > 0)
    {
      wrong.insert(next);
      tryRetractions(next + 1, allowed, doubt + records_[next].doubt, std::move(wrong));
    }
  }

  void tryExceptions(std::size_t next, int price, std::vector<std::size_t> chosen)
  {
    if (tooDear(doubt_, price))
    {
      return;
    }
    if (next < exceptions_.size())
    {
      tryExceptions(next + 1, price, chosen);
      chosen.push_back(next);
      tryExceptions(next + 1, price + exceptions_[next].price, std::move(chosen));
      return;
    }
    GroundBody initially;
    std::vector<std::string> assumed;
    for (std::size_t i = 0; i < records_.size(); ++i)
    {
      const GroundRecord& ground = records_[i];
      if (wrong_.count(i) > 0)
      {
        assumed.push_back("wrong(" + toString(ground.record) + ")");
      }
      else if (ground.impossible)
      {
        return;
      }
      else if (ground.literal && ground.record.step == 0)
      {
        initially.push_back(*ground.literal);
      }
    }
    for (const std::size_t i : chosen)
    {
      assumed.push_back(exceptions_[i].statement);
      initially.push_back(exceptions_[i].literal);
    }
    const std::set<Knowledge> known = closures(domain_, initially);
    for (std::size_t s = 0; s < diagram_.states().size(); ++s)
    {
      if (std::any_of(known.begin(), known.end(), [&](const Knowledge& closure) {
            return contains(diagram_.states()[s], closure);
          }))
      {
        follow({s}, price, assumed);
      }
    }
  }

  [[nodiscard]] bool contains(const Values& state, const Knowledge& closure) const
  {
    for (std::size_t f = 0; f < state.size(); ++f)
    {
      const auto count = static_cast<int>(domain_.fluents[f].values.size());
      for (int value = 0; value < count; ++value)
      {
        const bool is = state[f] == value;
        if (closure.has({static_cast<int>(f), value, !is}))
        {
          return false;
        }
      }
    }
    return true;
  }

  // ---- Paths ----

  void follow(const std::vector<std::size_t>& path, int price,
              const std::vector<std::string>& assumed)
  {
    const int step = static_cast<int>(path.size()) - 1;
    const Values& state = diagram_.states()[path.back()];
    for (std::size_t i = 0; i < records_.size(); ++i)
    {
      const GroundRecord& ground = records_[i];
      if (ground.literal && ground.record.step == step && wrong_.count(i) == 0 &&
          !holds(GroundBody{*ground.literal}, state))
      {
        return;
      }
    }
    if (tooDear(doubt_, price))
    {
      return;
    }
    if (step == last_)
    {
      keep(path, price, assumed);
      return;
    }
    std::set<int> happened;
    std::set<int> attempted;
    for (const GroundRecord& ground : records_)
    {
      if (ground.action >= 0 && ground.record.step == step)
      {
        (ground.record.kind == RecordKind::kHappened ? happened : attempted).insert(ground.action);
      }
    }
    std::vector<int> open;  // what may have happened, at a price if it did or if it did not
    for (const int action : attempted)
    {
      if (happened.count(action) == 0 && diagram_.possible(state, {action}))
      {
        open.push_back(action);
      }
    }
    for (std::size_t a = 0; exogenous_ && a < domain_.actions.size(); ++a)
    {
      if (domain_.actions[a].exogenous && happened.count(static_cast<int>(a)) == 0 &&
          attempted.count(static_cast<int>(a)) == 0)
      {
        open.push_back(static_cast<int>(a));
      }
    }
    for (std::size_t mask = 0; mask < (std::size_t{1} << open.size()); ++mask)
    {
      std::set<int> actions = happened;
      std::vector<std::string> more = assumed;
      int dearer = price;
      for (std::size_t i = 0; i < open.size(); ++i)
      {
        const std::string& name = domain_.actions[static_cast<std::size_t>(open[i])].name;
        const bool occurs = (mask >> i & 1U) != 0;
        const bool was_attempted = attempted.count(open[i]) > 0;
        if (occurs)
        {
          actions.insert(open[i]);
        }
        if (occurs != was_attempted)
        {
          more.push_back(was_attempted ? "failed(" + name + ", " + std::to_string(step) + ")"
                                       : name + " at " + std::to_string(step));
          dearer += options_.exogenous_weight;
        }
      }
      if (tooDear(doubt_, dearer) || !diagram_.possible(state, actions))
      {
        continue;
      }
      for (const std::size_t next : diagram_.successors(path.back(), actions))
      {
        std::vector<std::size_t> longer = path;
        longer.push_back(next);
        follow(longer, dearer, more);
      }
    }
  }

  void keep(const std::vector<std::size_t>& path, int price, std::vector<std::string> assumed)
  {
    if (models_.empty() || std::pair(doubt_, price) < best_)
    {
      models_.clear();
      best_ = {doubt_, price};
    }
    Model model{std::move(assumed), {}};
    std::sort(model.assumed.begin(), model.assumed.end());
    for (const std::size_t state : path)
    {
      model.states.push_back(diagram_.states()[state]);
    }
    models_.insert(std::move(model));
    if (models_.size() > kMaxModels)
    {
      throw ResourceExhausted("too many models to enumerate");
    }
  }

  GroundDomain domain_;
  Diagram diagram_;
  ReasonerOptions options_;
  std::vector<GroundRecord> records_;
  std::vector<Exception> exceptions_;
  int last_ = 0;
  bool exogenous_ = false;
  int doubt_ = 0;
  std::set<std::size_t> wrong_;
  std::pair<int, int> best_;  ///< price of retractions, of the rest
  std::set<Model> models_;
};

}  // namespace

Answers answersOf(const Description& description, const std::vector<Record>& records,
                  const ReasonerOptions& options)
{
  return HistorySearch(description, records, options).run();
}

}  // namespace kr3::reasoner::oracle
