#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace kr3::refinement
{

class Problems;

/// A part of something that the high level knows as one: a grid cell of a room, a module of a
/// device.
struct Component
{
  std::string name;
  std::string part_of;  ///< the element of the magnified sort
  int line = 0;         ///< in the map's file; 0: not from a file
};

/// What the map says about the components. Plain data; ComponentMap checks it.
struct ComponentMapData
{
  std::vector<Component> components;

  /// Indices of components beside each component, shape [components]. They become the facts of the
  /// one boolean static over two components that the refinement declares without facts; without
  /// such a static they are not used.
  std::vector<std::vector<std::size_t>> neighbors;

  /// Further ground facts over components, in the language: `heavy(m1)`, `height(m1) = 3`.
  std::vector<std::string> facts;

  /// Row-major, shape [components, components], m; infinity where there is no way. Empty: nobody
  /// knows, and costs cannot ask for them.
  std::vector<double> distances_m;

  /// Where the data come from, for messages.
  std::string source = "the map";
};

/// The components, their neighbours and distances. An immutable value.
///
/// Invariant: names are unique and not empty, indices and shapes fit, neighbours are so both ways
/// and none is its own, distances are not negative and not NaN.
class ComponentMap
{
public:
  /// @throws InvalidArgument  the data break the invariant; the message names each component
  explicit ComponentMap(ComponentMapData data);

  [[nodiscard]] std::size_t size() const { return data_.components.size(); }
  [[nodiscard]] const std::vector<Component>& components() const { return data_.components; }
  [[nodiscard]] const std::vector<std::size_t>& neighbors(std::size_t component) const
  {
    return data_.neighbors.at(component);
  }
  [[nodiscard]] const std::vector<std::string>& facts() const { return data_.facts; }
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;

  [[nodiscard]] const std::string& source() const { return data_.source; }

  /// Whether it is known how far apart components are.
  [[nodiscard]] bool hasDistances() const { return has_distances_; }

  /// m; infinity where there is no way, 0 where nobody knows.
  [[nodiscard]] double distance(std::size_t from, std::size_t to) const
  {
    return data_.distances_m[from * size() + to];
  }

private:
  void checkNames(Problems& problems);
  void checkNeighbors(std::size_t component, Problems& problems) const;
  void checkDistances(std::size_t component, Problems& problems) const;

  ComponentMapData data_;
  std::unordered_map<std::string, std::size_t> index_;
  bool has_distances_ = true;
};

/// A map for tools and tests: each whole becomes a grid of about square shape, the wholes stand in
/// a row.
///
/// @param per_whole  components of each whole, >= 1
/// @param pitch_m    distance between neighbouring components; distances are Manhattan distances
/// @throws InvalidArgument  no whole, no component per whole, pitch not positive
[[nodiscard]] ComponentMap gridMap(const std::vector<std::string>& wholes, std::size_t per_whole,
                                   double pitch_m);

/// Reads a map from a file, for domains whose components do not come from navigation (schema:
/// README.md).
///
/// @throws Unavailable      the file cannot be read
/// @throws InvalidArgument  malformed: every problem, one a line, "file:line: found, expected"
[[nodiscard]] ComponentMap readComponentMap(const std::string& path);

}  // namespace kr3::refinement
