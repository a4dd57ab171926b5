#include "search_team.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <thread>
#include <utility>

#include "barrier.hpp"
#include "exclusion_bound.hpp"

namespace kr3::pomdp
{

namespace
{

// Counted work in a round: little at first, because small problems are soon solved.
constexpr std::uint64_t kFirstRound = 1U << 14U;
constexpr std::uint64_t kLongestRound = 1U << 20U;  // or so many of the longest steps:
constexpr std::uint64_t kLongestSteps = 4;  // else who is ahead waits for a single step of another
constexpr std::uint64_t kGrowth = 8;  // a round is at most the work done so far divided by this

/// What the members do differently, so that they do not find the same.
SearchStyle styleOf(const SolverParts& parts, std::size_t member, std::size_t num_members)
{
  SearchStyle style;
  style.seed = member + 1;
  if (num_members > 1)
  {
    style.sampled_share = member % 2 == 0 ? 0.15 : 0.5;
    style.drawn_share = member == 0 ? 0.0 : 1.0;
  }
  if (!parts.sampled_trials)
  {
    style.sampled_share = 0.0;
  }
  else if (!parts.upper_trials)
  {
    style.sampled_share = 1.0;
  }
  return style;
}

}  // namespace

struct SearchTeam::Member
{
  Member(const ObservedModel& model, InformedVectors informed, const InformedVectors& blind,
         double precision, const SolverParts& parts, const SearchStyle& style,
         Supervisor& supervisor, bool with_grid)
    : source(parts.noise_free_bound
                 ? ExclusionBound::make(model, informed,
                                        [&supervisor] { return supervisor.mayPrepare(); })
                 : nullptr)
    , graph(model, std::move(informed), blind, source.get())
    , grid(with_grid ? std::make_unique<BeliefGrid>(
                           graph, [&supervisor] { return supervisor.mayPrepare(); })
                     : nullptr)
    , search(graph, grid.get(), precision, style, supervisor)
  {
  }
  [[nodiscard]] SearchState state()
  {
    return {search.lower(),     search.upper(),     search.backups(),
            graph.numVectors(), graph.numEntries(), sizeInBytes()};
  }
  [[nodiscard]] std::size_t sizeInBytes() const
  {
    return graph.sizeInBytes() + (grid == nullptr ? 0 : grid->sizeInBytes());
  }

  std::unique_ptr<UpperBoundSource> source;
  BeliefGraph graph;
  std::unique_ptr<BeliefGrid> grid;
  Search search;
  // Written by its own thread before the barrier, read by others after it.
  Findings findings;
  SearchState last{};
  std::uint64_t longest_step = 0;  // counted work
  double cpu_s = 0.0;
  std::exception_ptr failure;
  // Written by the calling thread between barriers.
  std::uint64_t most_backups = 0;  // at which its round ends
};

SearchTeam::SearchTeam(const ObservedModel& model, InformedVectors informed,
                       const InformedVectors& blind, const SolverLimits& limits,
                       const SolverParts& parts, Supervisor& supervisor)
  : limits_(&limits), supervisor_(&supervisor)
{
  const auto count = static_cast<std::size_t>(limits.num_threads);
  for (std::size_t i = 1; i < count; ++i)
  {
    members_.push_back(std::make_unique<Member>(model, informed, blind, limits.precision, parts,
                                                styleOf(parts, i, count), supervisor, false));
  }
  members_.insert(members_.begin(), std::make_unique<Member>(
                                        model, std::move(informed), blind, limits.precision, parts,
                                        styleOf(parts, 0, count), supervisor, parts.belief_grid));
}

SearchTeam::~SearchTeam() = default;

void SearchTeam::take(const Findings& findings)
{
  for (const std::unique_ptr<Member>& member : members_)
  {
    member->graph.take(findings);
  }
}

/// The rounds of a run with several members.
class SearchTeam::Rounds
{
public:
  explicit Rounds(SearchTeam& team) : team_(&team), barrier_(team.members_.size())
  {
    for (const std::unique_ptr<Member>& member : team.members_)
    {
      member->graph.recordFindings();
      member->last = member->state();
    }
    plan();
  }

  /// Every member calls this once, member 0 in the calling thread.
  void work(std::size_t index)
  {
    const double start_s = threadCpuSeconds();
    Member& member = *team_->members_[index];
    std::uint64_t end = member.graph.work();
    while (going_on_)
    {
      // What taking over cost in the last round counts, so that all are done at the same time.
      end += std::clamp(end / kGrowth, kFirstRound,
                        std::max(kLongestRound, kLongestSteps * longest_step_));
      attempt(member, [&] { workRound(index, end); });
      barrier_.wait();
      attempt(member, [&] {
        for (const std::unique_ptr<Member>& other : team_->members_)
        {
          if (other.get() != &member)
          {
            member.graph.take(other->findings);
          }
        }
      });
      if (index == 0)
      {
        plan();
      }
      barrier_.wait();
    }
    member.cpu_s = threadCpuSeconds() - start_s;
  }

private:
  template <typename Work>
  void attempt(Member& member, const Work& work)
  {
    try
    {
      work();
    }
    catch (...)
    {
      member.failure = std::current_exception();
      stop_now_ = true;
    }
  }

  void workRound(std::size_t index, std::uint64_t end)
  {
    Member& member = *team_->members_[index];
    while (!stop_now_ && member.graph.work() < end &&
           member.search.backups() < member.most_backups && goesOn(index))
    {
      const std::uint64_t before = member.graph.work();
      member.search.step();
      member.longest_step = std::max(member.longest_step, member.graph.work() - before);
    }
    member.findings = member.graph.takeFindings();
    member.last = member.state();
  }

  /// Member 0 reports for all; the others know only the time, their own bounds and memory.
  bool goesOn(std::size_t index)
  {
    Member& member = *team_->members_[index];
    if (index == 0)
    {
      const bool on = team_->supervisor_->mayGoOn(combined(member.state()));
      stop_now_ = stop_now_ || team_->supervisor_->isUrgent();
      return on;
    }
    if (team_->supervisor_->isTimeUp())
    {
      stop_now_ = true;
      return false;
    }
    const std::size_t share = team_->limits_->max_memory_bytes / team_->members_.size();
    return member.search.upper() - member.search.lower() > team_->limits_->precision &&
           (share == 0 || member.sizeInBytes() < share);
  }

  /// How far all are, when one is at `state` and the others where they were before the round.
  [[nodiscard]] SearchState combined(SearchState state) const
  {
    for (const SearchState& other : others_)
    {
      state.lower = std::max(state.lower, other.lower);
      state.upper = std::min(state.upper, other.upper);
      state.backups += other.backups;
      state.num_vectors = std::max(state.num_vectors, other.num_vectors);
      state.memory_bytes += other.memory_bytes;
    }
    return state;
  }

  /// Whether there is another round, and what is left of the backups for each member.
  void plan()
  {
    std::vector<std::unique_ptr<Member>>& members = team_->members_;
    others_.clear();
    for (std::size_t i = 1; i < members.size(); ++i)
    {
      others_.push_back(members[i]->last);
    }
    const SearchState state = combined(members.front()->last);
    going_on_ = team_->supervisor_->mayGoOn(state) && !stop_now_;
    const std::uint64_t most = team_->limits_->max_backups;
    for (std::size_t i = 0; i < members.size(); ++i)
    {
      longest_step_ = std::max(longest_step_, members[i]->longest_step);
      const std::uint64_t left = most > state.backups ? most - state.backups : 0;
      const std::uint64_t share = left / members.size() + (i < left % members.size() ? 1 : 0);
      members[i]->most_backups = most == 0 ? std::numeric_limits<std::uint64_t>::max()
                                           : members[i]->search.backups() + share;
    }
  }

  SearchTeam* team_;
  Barrier barrier_;
  std::vector<SearchState> others_;     // all but member 0, before this round
  bool going_on_ = true;                // written between barriers, as the next
  std::uint64_t longest_step_ = 0;      // of any member
  std::atomic<bool> stop_now_ = false;  // the time is up, the caller cancelled, or a search threw
};

void SearchTeam::run()
{
  if (members_.size() == 1)
  {
    Member& member = *members_.front();
    while (supervisor_->mayGoOn(member.state()))
    {
      member.search.step();
    }
    return;
  }
  Rounds rounds(*this);
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < members_.size(); ++i)
  {
    threads.emplace_back([&rounds, i] { rounds.work(i); });
  }
  rounds.work(0);
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  for (std::size_t i = 0; i < members_.size(); ++i)
  {
    supervisor_->countCpuSeconds(i == 0 ? 0.0 : members_[i]->cpu_s);
    if (members_[i]->failure != nullptr)
    {
      std::rethrow_exception(members_[i]->failure);
    }
  }
}

const BeliefGraph& SearchTeam::graph() const
{
  return members_.front()->graph;
}

double SearchTeam::upper()
{
  double least = members_.front()->search.upper();
  for (const std::unique_ptr<Member>& member : members_)
  {
    least = std::min(least, member->search.upper());
  }
  return least;
}

std::size_t SearchTeam::sizeInBytes() const
{
  std::size_t bytes = 0;
  for (const std::unique_ptr<Member>& member : members_)
  {
    bytes += member->sizeInBytes();
  }
  return bytes;
}

}  // namespace kr3::pomdp
