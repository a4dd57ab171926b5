#include "kr3_executive/skills_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <kr3_common/error.hpp>

namespace kr3::executive::skills
{
namespace
{

double distanceOutside(const CellArea& cell, const Point& p)
{
  return std::hypot(std::max(0.0, std::abs(p.x - cell.center.x) - cell.size_x_m / 2.0),
                    std::max(0.0, std::abs(p.y - cell.center.y) - cell.size_y_m / 2.0));
}

}  // namespace

CellMap::CellMap(const std::vector<CellArea>& cells)
{
  for (const CellArea& cell : cells)
  {
    if (!(cell.size_x_m > 0.0 && cell.size_y_m > 0.0))
      throw InvalidArgument("cell '" + cell.name + "' has no positive size");
    if (!cells_.emplace(cell.name, cell).second)
      throw InvalidArgument("cell '" + cell.name + "' is there twice");
  }
  if (cells_.empty())
    throw InvalidArgument("there are no cells");
}

const CellArea& CellMap::at(const std::string& name) const
{
  const auto cell = cells_.find(name);
  if (cell == cells_.end())
    throw InvalidArgument("no cell is called '" + name + "'");
  return cell->second;
}

double CellMap::distanceTo(const std::string& name, const Point& p_map) const
{
  return distanceOutside(at(name), p_map);
}

const CellArea& CellMap::holding(const Point& p_map, const std::string& viewer_room,
                                 const std::string& preferred, double margin_m,
                                 double other_room_penalty_m) const
{
  const auto wanted = cells_.find(preferred);
  if (wanted != cells_.end() && distanceOutside(wanted->second, p_map) <= margin_m)
    return wanted->second;
  const CellArea* best = nullptr;
  double best_distance = std::numeric_limits<double>::infinity();
  for (const auto& [name, cell] : cells_)
  {
    const double penalty = cell.room == viewer_room ? 0.0 : other_room_penalty_m;
    const double candidate = distanceOutside(cell, p_map) + penalty;
    if (candidate < best_distance)
    {
      best = &cell;
      best_distance = candidate;
    }
  }
  return *best;
}

void SearchLog::add(const Sighting& sighting)
{
  if (!best_ || sighting.probability > best_->probability)
    best_ = sighting;
}

bool SearchLog::sure(const SearchOptions& options) const
{
  return best_ && best_->probability >= options.sure_probability;
}

SearchResult SearchLog::result(const CellMap& cells, const std::string& cell,
                               const SearchOptions& options) const
{
  const std::string& room = cells.at(cell).room;
  if (!best_ || best_->probability < options.accept_probability)
    return {false, std::nullopt, options.miss_confidence};
  const CellArea& where = cells.holding(best_->p_map, room, cell, options.boundary_margin_m,
                                        options.other_room_penalty_m);
  return {where.name == cell, where.name, best_->probability};
}

}  // namespace kr3::executive::skills
