#include "kr3_common/nearest_name.hpp"

#include <algorithm>
#include <numeric>

namespace kr3
{

std::size_t editDistance(std::string_view a, std::string_view b, std::size_t limit)
{
  const std::size_t difference = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
  if (difference > limit)
  {
    return limit + 1;
  }
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i)
  {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j)
    {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
    if (*std::min_element(row.begin(), row.end()) > limit)  // it never shrinks again
    {
      return limit + 1;
    }
  }
  return row.back();
}

const std::string* nearestName(std::string_view name, const std::vector<std::string>& candidates,
                               std::size_t limit)
{
  const std::string* nearest = nullptr;
  std::size_t within = limit;
  for (const std::string& candidate : candidates)
  {
    const std::size_t distance = editDistance(name, candidate, within);
    if (distance <= within)
    {
      nearest = &candidate;
      if (distance == 0)
      {
        break;
      }
      within = distance - 1;  // only a nearer one replaces it
    }
  }
  return nearest;
}

}  // namespace kr3
