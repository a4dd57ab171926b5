#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kr3_executive/skills_geometry.hpp"

namespace kr3::executive::skills
{

/// A cell of a room: an axis-aligned rectangle of the map.
struct CellArea
{
  std::string name;
  std::string room;
  Point center;
  double size_x_m = 0.0;
  double size_y_m = 0.0;
  Point stand{};  ///< free, where the robot stands in it
};

/// The cells of a building. An immutable value.
class CellMap
{
public:
  /// @throws InvalidArgument  no cells, a name twice, or a size that is not positive
  explicit CellMap(const std::vector<CellArea>& cells);

  /// @throws InvalidArgument  no such cell
  [[nodiscard]] const CellArea& at(const std::string& name) const;

  /// How far a point is outside a cell; 0 inside.
  /// @throws InvalidArgument  no such cell
  [[nodiscard]] double distanceTo(const std::string& name, const Point& p_map) const;

  /// The cell that holds something seen at `p_map` from a place in `viewer_room`. Positions are a
  /// little wrong and walls hide things, so a cell of another room must be nearer by
  /// `other_room_penalty_m` to win; among equal distances the cell `preferred` wins when the point
  /// is at most `margin_m` outside it.
  [[nodiscard]] const CellArea& holding(const Point& p_map, const std::string& viewer_room,
                                        const std::string& preferred, double margin_m,
                                        double other_room_penalty_m) const;

private:
  std::map<std::string, CellArea> cells_;
};

/// An object seen once.
struct Sighting
{
  Point p_map;
  double probability = 0.0;  ///< calibrated, that it is really the object
};

struct SearchOptions
{
  double accept_probability = 0.5;    ///< from which a sighting counts, (0, 1)
  double sure_probability = 0.9;      ///< from which the search ends at once, (0, 1]
  double miss_confidence = 0.9;       ///< that an object in the cell would have been seen, (0, 1]
  double boundary_margin_m = 0.15;    ///< by which a sighting may lie outside its cell
  double other_room_penalty_m = 0.4;  ///< see CellMap::holding()
};

/// What a search concluded.
struct SearchResult
{
  bool found = false;                ///< in the cell that was searched
  std::optional<std::string> where;  ///< the cell that holds it, if it was seen at all
  double confidence = 0.0;
};

/// Sightings of one object during one search. Single-threaded.
class SearchLog
{
public:
  void add(const Sighting& sighting);

  [[nodiscard]] const std::optional<Sighting>& best() const { return best_; }

  /// Whether further looking is useless.
  [[nodiscard]] bool sure(const SearchOptions& options) const;

  /// @throws InvalidArgument  no such cell
  [[nodiscard]] SearchResult result(const CellMap& cells, const std::string& cell,
                                    const SearchOptions& options) const;

private:
  std::optional<Sighting> best_;
};

}  // namespace kr3::executive::skills
