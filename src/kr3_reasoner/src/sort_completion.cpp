#include "sort_completion.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "builder.hpp"
#include "diagnostics.hpp"

namespace kr3::reasoner
{

namespace
{

/// Visits sorts depth first, members before the unions they are in, without recursion: a chain of
/// sorts may be long.
class Completion
{
public:
  Completion(std::vector<Sort>& sorts, std::vector<Diagnostic>& problems)
    : sorts_(sorts), problems_(problems)
  {
    for (std::size_t i = 0; i < sorts_.size(); ++i)
    {
      index_.emplace(sorts_[i].name, i);
    }
    marks_.assign(sorts_.size(), Mark::kNew);
  }

  bool run()
  {
    for (std::size_t i = 0; i < sorts_.size() && !overfull_; ++i)
    {
      visit(i);
    }
    return !overfull_;
  }

private:
  enum class Mark
  {
    kNew,
    kOpen,
    kDone
  };
  struct Visit
  {
    std::size_t sort;
    std::size_t next_member;
  };

  void visit(std::size_t root)
  {
    std::vector<Visit> path;
    open(root, path);
    while (!path.empty() && !overfull_)
    {
      const std::size_t current = path.back().sort;
      const std::vector<std::string>& members = sorts_[current].member_sorts;
      if (path.back().next_member == members.size())
      {
        complete(sorts_[current]);
        marks_[current] = Mark::kDone;
        path.pop_back();
        continue;
      }
      const std::string& member = members[path.back().next_member++];
      const auto found = index_.find(member);
      if (found == index_.end())
      {
        problems_.push_back({sorts_[current].position,
                             "unknown sort '" + member + "'" + suggestion(member, names())});
      }
      else if (marks_[found->second] == Mark::kOpen)
      {
        problems_.push_back({sorts_[current].position, "the sort " + sorts_[current].name +
                                                           " contains itself through " + member +
                                                           ", expected no cycle of sorts"});
      }
      else
      {
        open(found->second, path);
      }
    }
  }

  void open(std::size_t sort, std::vector<Visit>& path)
  {
    if (marks_[sort] == Mark::kNew)
    {
      marks_[sort] = Mark::kOpen;
      path.push_back({sort, 0});
    }
  }

  void complete(Sort& sort)
  {
    std::unordered_set<std::string_view> known;
    for (const std::string& element : sort.elements)
    {
      if (!known.insert(element).second)
      {
        problems_.push_back(
            {sort.position, "the sort " + sort.name + " has the element '" + element + "' twice"});
      }
    }
    std::vector<std::string> inherited;
    for (const std::string& member : sort.member_sorts)
    {
      const auto found = index_.find(member);
      if (found == index_.end() || &sorts_[found->second] == &sort)
      {
        continue;
      }
      for (const std::string& element : sorts_[found->second].elements)
      {
        if (known.insert(element).second)
        {
          inherited.push_back(element);
        }
      }
    }
    sort.elements.insert(sort.elements.end(), inherited.begin(), inherited.end());
    num_elements_ += sort.elements.size();
    if (num_elements_ > kMaxElements)
    {
      overfull_ = true;
      problems_.push_back({sort.position, "found more than " + std::to_string(kMaxElements) +
                                              " elements in all sorts together, expected fewer"});
    }
  }

  [[nodiscard]] std::vector<std::string> names() const
  {
    std::vector<std::string> names;
    constexpr std::size_t kEnough = 100;
    for (const Sort& sort : sorts_)
    {
      if (problems_.size() >= kEnough)
      {
        break;
      }
      names.push_back(sort.name);
    }
    return names;
  }

  std::vector<Sort>& sorts_;
  std::vector<Diagnostic>& problems_;
  std::unordered_map<std::string, std::size_t> index_;
  std::vector<Mark> marks_;
  std::size_t num_elements_ = 0;
  bool overfull_ = false;
};

}  // namespace

bool completeSorts(Description& description, std::vector<Diagnostic>& problems)
{
  return Completion(description.sorts, problems).run();
}

}  // namespace kr3::reasoner
