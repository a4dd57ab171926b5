#include "world_octomap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include <octomap/OcTree.h>

#include <kr3_common/error.hpp>

namespace kr3::sim
{

namespace
{
constexpr double kMaxVoxels = 2e8;
constexpr double kMaxKey = 32000.0;  // OctoMap's keys have 16 bits, the origin is in the middle
constexpr double kTouching = 1e-4;   // m: solids that reach less deep into a voxel leave it free
constexpr float kOccupied = 3.5F;    // log odds, OctoMap's usual limits
constexpr float kFree = -2.0F;

/// Voxels by their integer coordinates: voxel i reaches from i to i + 1 times the resolution.
struct VoxelRange
{
  std::array<int, 3> first;
  std::array<int, 3> last;  // past the end

  template <typename Visit>
  void forEach(const Visit& visit) const
  {
    for (int x = first[0]; x < last[0]; ++x)
    {
      for (int y = first[1]; y < last[1]; ++y)
      {
        for (int z = first[2]; z < last[2]; ++z)
        {
          visit(x, y, z);
        }
      }
    }
  }
};

void check(const Building& building, const OctomapOptions& options)
{
  const Rectangle all = building.extent();
  if (!(options.resolution_m > 0.0) || !std::isfinite(options.resolution_m))
  {
    throw InvalidArgument("OctoMap resolution " + std::to_string(options.resolution_m) +
                          " m, expected above 0");
  }
  if (!(options.z_min_m < options.z_max_m) || !std::isfinite(options.z_min_m) ||
      !std::isfinite(options.z_max_m))
  {
    throw InvalidArgument("OctoMap heights from " + std::to_string(options.z_min_m) + " to " +
                          std::to_string(options.z_max_m) + " m, expected the lower one first");
  }
  const double reach =
      std::max({std::abs(all.x0), std::abs(all.x1), std::abs(all.y0), std::abs(all.y1),
                std::abs(options.z_min_m), std::abs(options.z_max_m)});
  const double voxels = (all.x1 - all.x0) * (all.y1 - all.y0) *
                        (options.z_max_m - options.z_min_m) / std::pow(options.resolution_m, 3);
  if (reach / options.resolution_m > kMaxKey || voxels > kMaxVoxels)
  {
    throw InvalidArgument("OctoMap resolution " + std::to_string(options.resolution_m) +
                          " m is too fine for this building and these heights");
  }
}

class Voxels
{
public:
  explicit Voxels(const OctomapOptions& options)
    : resolution_(options.resolution_m)
    , first_layer_(static_cast<int>(std::ceil(options.z_min_m / resolution_ - 0.5 - 1e-9)))
    , past_layer_(static_cast<int>(std::ceil(options.z_max_m / resolution_ - 0.5 - 1e-9)))
    , tree_(options.resolution_m)
    , probe_(dCreateBox(nullptr, resolution_ - 2.0 * kTouching, resolution_ - 2.0 * kTouching,
                        resolution_ - 2.0 * kTouching))
  {
  }

  /// All voxels whose centre is in the rectangle.
  void addFree(const Rectangle& r)
  {
    const auto centered = [&](double value) {
      return static_cast<int>(std::ceil(value / resolution_ - 0.5 - 1e-9));
    };
    const VoxelRange range{{centered(r.x0), centered(r.y0), first_layer_},
                           {centered(r.x1), centered(r.y1), past_layer_}};
    range.forEach([&](int x, int y, int z) { set(x, y, z, kFree); });
  }

  /// All voxels that the geom reaches into.
  void addOccupied(dGeomID geom)
  {
    std::array<dReal, 6> bounds{};
    dGeomGetAABB(geom, bounds.data());
    const auto below = [&](double value) {
      return static_cast<int>(std::floor((value + kTouching) / resolution_));
    };
    const auto above = [&](double value) {
      return static_cast<int>(std::ceil((value - kTouching) / resolution_));
    };
    const VoxelRange range{
        {below(bounds[0]), below(bounds[2]), std::max(below(bounds[4]), first_layer_)},
        {above(bounds[1]), above(bounds[3]), std::min(above(bounds[5]), past_layer_)}};
    range.forEach([&](int x, int y, int z) {
      dGeomSetPosition(probe_.get(), (x + 0.5) * resolution_, (y + 0.5) * resolution_,
                       (z + 0.5) * resolution_);
      dContactGeom contact;
      if (dCollide(probe_.get(), geom, 1, &contact, sizeof(contact)) > 0)
      {
        set(x, y, z, kOccupied);
      }
    });
  }

  [[nodiscard]] std::vector<std::uint8_t> bytes()
  {
    tree_.updateInnerOccupancy();
    tree_.toMaxLikelihood();
    tree_.prune();
    std::ostringstream stream;
    // The header of OctoMap's writeBinary(), which also prints to the terminal.
    stream << "# Octomap OcTree binary file\nid " << tree_.getTreeType() << "\nsize "
           << tree_.size() << "\nres " << tree_.getResolution() << "\ndata\n";
    if (!tree_.writeBinaryData(stream))
    {
      throw InternalError("OctoMap could not serialise the world");
    }
    const std::string text = stream.str();
    return {text.begin(), text.end()};
  }

private:
  void set(int x, int y, int z, float log_odds)
  {
    constexpr int kMiddle = 32768;
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(x + kMiddle),
                                 static_cast<octomap::key_type>(y + kMiddle),
                                 static_cast<octomap::key_type>(z + kMiddle));
    tree_.setNodeValue(key, log_odds, true);
  }

  double resolution_;
  int first_layer_;
  int past_layer_;
  octomap::OcTree tree_;
  GeomHandle probe_;
};
}  // namespace

std::vector<std::uint8_t> octomapOf(const Building& building, const Physics& physics,
                                    dBodyID hidden, const OctomapOptions& options)
{
  check(building, options);
  Voxels voxels(options);
  for (const Place& place : building.places)
  {
    voxels.addFree(place.rectangle);
  }
  for (dGeomID geom : physics.solids())
  {
    if (hidden == nullptr || dGeomGetBody(geom) != hidden)
    {
      voxels.addOccupied(geom);
    }
  }
  return voxels.bytes();
}

void saveOctomap(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  const std::string partial = path + ".partial";
  {
    std::ofstream file(partial, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file)
    {
      throw Unavailable("cannot write '" + partial + "'");
    }
  }
  if (std::rename(partial.c_str(), path.c_str()) != 0)
  {
    throw Unavailable("cannot write '" + path + "'");
  }
}

}  // namespace kr3::sim
