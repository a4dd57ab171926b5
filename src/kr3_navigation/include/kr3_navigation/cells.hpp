#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kr3_navigation/path_planner.hpp"
#include "kr3_navigation/places.hpp"

namespace kr3::navigation
{

/// A part of a place: the low level's unit of where something is.
struct Cell
{
  std::string name;  ///< "<place>_c<i>", i row-major from the corner with the lowest coordinates
  std::string place;
  Rectangle rectangle;                 ///< map frame
  Point stand;                         ///< where the robot goes; the centre when not reachable
  bool reachable = false;              ///< a stand point was found
  std::vector<std::size_t> neighbors;  ///< cells one gets into by a small slip, ascending
};

struct CellOptions
{
  int cells_per_room = 4;
  double margin_m = 0.2;  ///< stand points keep this far from the cell's border, if they can
  double stand_clearance_m = 0.40;  ///< and this far from obstacles, if they can
  double passage_depth_m =
      0.6;  ///< half the greatest depth of a passage that joins cells of two places
};

/// The cells of a building. Invariant: names are unique; neighbours and distances are symmetric.
class CellMap
{
public:
  /// Cuts every place into cells and measures the ways between them.
  /// Cost: one Dijkstra search per cell.
  CellMap(const std::vector<Place>& places, const CellOptions& options, const PathPlanner& planner);

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  /// Length of the way between the stand points, m; +inf when there is none.
  [[nodiscard]] double travelDistance(std::size_t from, std::size_t to) const
  {
    return travel_distance_m_[from * cells_.size() + to];
  }
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  /// The name most like `name`, for an error message.
  [[nodiscard]] const std::string& nearestName(const std::string& name) const;
  /// The cell that holds p, or the nearest one to it (in a wall or passage).
  [[nodiscard]] std::size_t cellAt(Point p) const;

private:
  void findNeighbors(const CellOptions& options, const PathPlanner& planner);

  std::vector<Cell> cells_;
  std::vector<double> travel_distance_m_;
};

/// Rectangles of about `count` equal cells of a place, row-major: 2 x 2 for 4 cells of a squarish
/// room, a row of 4 along a corridor.
/// @throws InvalidArgument  fewer than 1 or more than 1000 cells
[[nodiscard]] std::vector<Rectangle> splitIntoCells(const Rectangle& place, int count);

/// Where the robot can stand in a cell: the free point of the main region nearest to the centre,
/// with clearance and away from the border where possible.
[[nodiscard]] std::optional<Point> standIn(const Rectangle& cell, const CellOptions& options,
                                           const PathPlanner& planner);

/// The cell's stand point while it can be reached, else another point of the cell, for something
/// may stand there today; the stand point again when there is none.
[[nodiscard]] Point presentStand(const Cell& cell, const CellOptions& options,
                                 const PathPlanner& planner);

/// What a person should know about cells in which the robot cannot stand, a sentence each: places
/// that the map does not show, places without any such cell, single cells; and whether no cell is
/// left at all.
/// @param places  those that the cells are of
[[nodiscard]] std::vector<std::string> describeUnreachable(const CellMap& map,
                                                           const std::vector<Place>& places,
                                                           const OccupancyGrid& grid);

}  // namespace kr3::navigation
