#include "kr3_navigation/occupancy_map.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <octomap/OcTree.h>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{

struct OccupancyMap::Impl
{
  explicit Impl(const octomap::OcTree& other) : tree(other) { tree.enableChangeDetection(true); }
  explicit Impl(const OccupancyMapOptions& options) : tree(options.resolution_m)
  {
    configure(options);
  }

  void configure(const OccupancyMapOptions& options)
  {
    tree.setProbHit(options.probability_hit);
    tree.setProbMiss(options.probability_miss);
    tree.enableChangeDetection(true);
  }

  octomap::OcTree tree;
};

namespace
{

void checkOptions(const OccupancyMapOptions& options)
{
  if (!(options.resolution_m > 0.0))
    throw InvalidArgument("map resolution " + std::to_string(options.resolution_m) +
                          " m, expected > 0");
  if (!(options.probability_hit > 0.5 && options.probability_hit < 1.0))
    throw InvalidArgument("probability of a hit " + std::to_string(options.probability_hit) +
                          ", expected in (0.5, 1)");
  if (!(options.probability_miss > 0.0 && options.probability_miss < 0.5))
    throw InvalidArgument("probability of a miss " + std::to_string(options.probability_miss) +
                          ", expected in (0, 0.5)");
}

/// What stands before the nodes of a binary file.
struct BinaryHeader
{
  double resolution_m = 0.0;
  std::size_t num_nodes = 0;
  std::size_t data_begin = 0;  ///< index of the first byte of the nodes
};

/// Counts the nodes that a binary file's data describe.
///
/// Each inner node has two bits for each of eight children: unknown, one of two kinds of leaf, or
/// inner; inner children follow depth first. Source: OctoMap's format, Hornung et al. (2013),
/// Sec. 3.4.
class NodeCounter
{
public:
  NodeCounter(const std::string& bytes, std::size_t begin, std::string source)
    : bytes_(bytes), next_(begin), source_(std::move(source))
  {
  }

  /// @throws InvalidArgument  the data end too early, or nodes are nested too deeply
  std::size_t count()
  {
    const std::size_t nodes = countInner(0);
    if (next_ != bytes_.size())
      fail(std::to_string(bytes_.size() - next_) + " bytes too many");
    return nodes;
  }

private:
  static constexpr int kMaxDepth = 16;

  [[noreturn]] void fail(const std::string& problem) const
  {
    throw InvalidArgument(source_ + " is damaged at byte " + std::to_string(next_) + ": " +
                          problem);
  }

  std::size_t countInner(int depth)
  {
    if (depth >= kMaxDepth)
      fail("nodes below the finest level");
    if (bytes_.size() - next_ < 2)
      fail("the nodes end too early");
    const unsigned int children =
        static_cast<unsigned char>(bytes_[next_]) |
        static_cast<unsigned int>(static_cast<unsigned char>(bytes_[next_ + 1])) << 8U;
    next_ += 2;
    std::size_t nodes = 1;
    for (unsigned int child = 0; child < 8; ++child)
    {
      constexpr unsigned int kInner = 3;
      const unsigned int kind = (children >> (2 * child)) & 3U;
      if (kind == kInner)
        nodes += countInner(depth + 1);
      else if (kind != 0)
        ++nodes;
    }
    return nodes;
  }

  const std::string& bytes_;
  std::size_t next_;
  std::string source_;
};

/// Reads the header and checks that the data are what it says: OctoMap itself trusts them, and
/// recurses without end in a file that is cut off.
/// @throws InvalidArgument  says what was found
BinaryHeader checkedHeader(const std::string& bytes, const std::string& source)
{
  constexpr const char* kMagic = "# Octomap OcTree binary file";
  if (bytes.compare(0, std::string(kMagic).size(), kMagic) != 0)
    throw InvalidArgument(source + " is not a binary OctoMap file (.bt): it does not begin with '" +
                          kMagic + "'");
  BinaryHeader header;
  std::istringstream lines(bytes);
  std::string line;
  std::string id;
  int number = 0;
  bool has_data = false;
  while (!has_data && std::getline(lines, line))
  {
    ++number;
    std::istringstream words(line);
    std::string key;
    words >> key;
    const bool known = key.empty() || key[0] == '#' || (key == "id" && words >> id) ||
                       (key == "size" && words >> header.num_nodes) ||
                       (key == "res" && words >> header.resolution_m) || key == "data";
    if (!known)
      throw InvalidArgument(source + ":" + std::to_string(number) +
                            ": expected id, size, res or data with a value, found '" +
                            line.substr(0, 60) + "'");
    has_data = key == "data";
  }
  if (!has_data || id != "OcTree")
    throw InvalidArgument(source + ": expected a header with `id OcTree` and `data`, found id '" +
                          id + "'");
  if (!(header.resolution_m >= 0.001 && header.resolution_m <= 10.0))
    throw InvalidArgument(source + ": the resolution is " + std::to_string(header.resolution_m) +
                          " m, expected 0.001 to 10");
  header.data_begin = static_cast<std::size_t>(lines.tellg());
  const std::size_t nodes = NodeCounter(bytes, header.data_begin, source).count();
  if (nodes != header.num_nodes)
    throw InvalidArgument(source + ": the header says " + std::to_string(header.num_nodes) +
                          " nodes, the data have " + std::to_string(nodes));
  return header;
}

constexpr std::size_t kDropoutNeighbors = 2;
constexpr double kMaxSurfaceGap = 1.0;  // m

/// Whether a beam truly saw nothing: single beams without a return are dropouts of the laser, so
/// its neighbours must have none either.
bool seesNothing(const LaserScan& scan, std::size_t beam)
{
  if (beam < kDropoutNeighbors || beam + kDropoutNeighbors >= scan.ranges_m.size())
    return false;
  for (std::size_t k = beam - kDropoutNeighbors; k <= beam + kDropoutNeighbors; ++k)
  {
    if (!(static_cast<double>(scan.ranges_m[k]) >= scan.range_max_m))
      return false;
  }
  return true;
}

/// The end of each beam in the map, OctoMap's input: hits, and for beams that saw nothing a point
/// beyond the range.
octomap::Pointcloud cloudOf(const LaserScan& scan, const Pose& T_map_laser, double height_m,
                            double max_range_m)
{
  octomap::Pointcloud cloud;
  cloud.reserve(scan.ranges_m.size());
  const auto add = [&](double range, double angle) {
    cloud.push_back(static_cast<float>(T_map_laser.x + range * std::cos(angle)),
                    static_cast<float>(T_map_laser.y + range * std::sin(angle)),
                    static_cast<float>(height_m));
  };
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam)
  {
    const double angle = T_map_laser.yaw + scan.angle(beam);
    if (scan.isHit(beam))
      add(static_cast<double>(scan.ranges_m[beam]), angle);
    else if (scan.range_max_m >= max_range_m && seesNothing(scan, beam))
      add(max_range_m * 1.01, angle);
  }
  return cloud;
}

/// Nodes that this scan must not call free: next to a hit, or to the surface between the hits of
/// two adjacent beams, through whose nodes a grazing beam passes.
octomap::KeySet surfaceKeys(const octomap::OcTree& tree, const LaserScan& scan,
                            const Pose& T_map_laser, double height_m, double max_range_m)
{
  octomap::KeySet keys;
  const auto add = [&](Point p) {
    octomap::OcTreeKey key;
    if (!tree.coordToKeyChecked(p.x, p.y, height_m, key))
      return;
    for (int dx = -1; dx <= 1; ++dx)
    {
      for (int dy = -1; dy <= 1; ++dy)
        keys.insert(octomap::OcTreeKey(static_cast<octomap::key_type>(key[0] + dx),
                                       static_cast<octomap::key_type>(key[1] + dy), key[2]));
    }
  };
  const auto in_range = [&](std::size_t beam) {
    return scan.isHit(beam) && static_cast<double>(scan.ranges_m[beam]) <= max_range_m;
  };
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam)
  {
    if (!in_range(beam))
      continue;
    const Point hit = T_map_laser * scan.endpoint(beam);
    add(hit);
    const std::size_t next = (beam + 1) % scan.ranges_m.size();
    if (!in_range(next))
      continue;
    const Point next_hit = T_map_laser * scan.endpoint(next);
    const double gap = distance(hit, next_hit);
    if (gap > kMaxSurfaceGap)
      continue;
    const int count = static_cast<int>(gap / tree.getResolution());
    for (int i = 1; i <= count; ++i)
    {
      const double t = static_cast<double>(i) / (count + 1);
      add({hit.x + t * (next_hit.x - hit.x), hit.y + t * (next_hit.y - hit.y)});
    }
  }
  return keys;
}

}  // namespace

OccupancyMap::OccupancyMap(const OccupancyMapOptions& options)
{
  checkOptions(options);
  impl_ = std::make_unique<Impl>(options);
}

OccupancyMap::OccupancyMap(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;
OccupancyMap::~OccupancyMap() = default;

OccupancyMap OccupancyMap::copy() const
{
  return OccupancyMap(std::make_unique<Impl>(impl_->tree));
}

OccupancyMap OccupancyMap::coarsened(double resolution_m) const
{
  constexpr double kRounding = 1e-9;
  constexpr double kMaxCoarseNodes = 2e7;  // 0.1 us each
  const octomap::OcTree& fine = impl_->tree;
  unsigned int depth = fine.getTreeDepth();
  double resolution = fine.getResolution();
  while (depth > 1 && 2.0 * resolution <= resolution_m + kRounding)
  {
    resolution *= 2.0;
    --depth;
  }
  if (depth == fine.getTreeDepth())
    return copy();
  OccupancyMapOptions options;
  options.resolution_m = resolution;
  auto impl = std::make_unique<Impl>(options);
  octomap::OcTree& coarse = impl->tree;
  coarse.setProbHit(fine.getProbHit());
  coarse.setProbMiss(fine.getProbMiss());
  double num_nodes = 0.0;
  for (auto leaf = fine.begin_leafs(static_cast<unsigned char>(depth)), end = fine.end_leafs();
       leaf != end; ++leaf)
    num_nodes += std::pow(leaf.getSize() / resolution, 3.0);
  if (num_nodes > kMaxCoarseNodes)
    throw InvalidArgument("the map fills " + std::to_string(num_nodes * std::pow(resolution, 3.0)) +
                          " cubic metres, too many in nodes of " + std::to_string(resolution) +
                          " m: more than 20 million");
  // An inner node's occupancy is the greatest of its children's.
  for (auto leaf = fine.begin_leafs(static_cast<unsigned char>(depth)), end = fine.end_leafs();
       leaf != end; ++leaf)
  {
    const double half = leaf.getSize() / 2.0 - resolution / 2.0;
    const auto count = static_cast<int>(std::lround(leaf.getSize() / resolution));
    const auto at = [&](double center, int i) {
      return static_cast<float>(center - half + i * resolution);
    };
    for (int x = 0; x < count; ++x)
    {
      for (int y = 0; y < count; ++y)
      {
        for (int z = 0; z < count; ++z)
          coarse.setNodeValue(at(leaf.getX(), x), at(leaf.getY(), y), at(leaf.getZ(), z),
                              leaf->getLogOdds(), true);
      }
    }
  }
  coarse.updateInnerOccupancy();
  coarse.prune();
  coarse.resetChangeDetection();
  return OccupancyMap(std::move(impl));
}

OccupancyMap OccupancyMap::load(const std::filesystem::path& path,
                                const OccupancyMapOptions& options)
{
  checkOptions(options);
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Unavailable("cannot open the map " + path.string());
  std::ostringstream bytes;
  bytes << file.rdbuf();
  const BinaryHeader header = checkedHeader(bytes.str(), path.string());
  auto impl = std::make_unique<Impl>(options);
  impl->tree.setResolution(header.resolution_m);
  std::istringstream data(bytes.str().substr(header.data_begin));
  if (!impl->tree.readBinaryData(data))
    throw InternalError("OctoMap could not read the checked map " + path.string());
  impl->configure(options);
  return OccupancyMap(std::move(impl));
}

void OccupancyMap::insertScan(const LaserScan& scan, const Pose& T_map_laser, double height_m,
                              double max_range_m, const DistanceField* known,
                              double known_distance_m)
{
  octomap::OcTree& tree = impl_->tree;
  const octomap::point3d origin(static_cast<float>(T_map_laser.x),
                                static_cast<float>(T_map_laser.y), static_cast<float>(height_m));
  octomap::KeySet free_keys;
  octomap::KeySet hit_keys;
  tree.computeUpdate(cloudOf(scan, T_map_laser, height_m, max_range_m), origin, free_keys, hit_keys,
                     max_range_m);

  const octomap::KeySet guarded = surfaceKeys(tree, scan, T_map_laser, height_m, max_range_m);
  for (const octomap::OcTreeKey& key : free_keys)
  {
    if (guarded.count(key) == 0)
      tree.updateNode(key, false);
  }
  for (const octomap::OcTreeKey& key : hit_keys)
  {
    if (known != nullptr)
    {
      const octomap::point3d center = tree.keyToCoord(key);
      const Point p{static_cast<double>(center.x()), static_cast<double>(center.y())};
      if (known->at(p, DistanceField::kFarDistance) < known_distance_m)
      {
        const octomap::OcTreeNode* node = tree.search(key);
        if (node == nullptr || !tree.isNodeOccupied(node))
          continue;
      }
    }
    tree.updateNode(key, true);
  }
}

bool OccupancyMap::hasChanges() const
{
  return impl_->tree.numChangesDetected() > 0;
}
void OccupancyMap::clearChanges()
{
  impl_->tree.resetChangeDetection();
}
Rectangle OccupancyMap::extent() const
{
  Rectangle extent{0.0, 0.0, 0.0, 0.0};
  if (impl_->tree.size() == 0)
    return extent;
  double z = 0.0;
  impl_->tree.getMetricMin(extent.x_min, extent.y_min, z);
  impl_->tree.getMetricMax(extent.x_max, extent.y_max, z);
  return extent;
}
double OccupancyMap::resolution() const
{
  return impl_->tree.getResolution();
}
std::size_t OccupancyMap::numLeaves() const
{
  return impl_->tree.getNumLeafNodes();
}

OccupancyGrid OccupancyMap::project(double z_min_m, double z_max_m, const Rectangle& area) const
{
  constexpr double kMaxNodes = 25e6;  // 500 m x 500 m at 0.1 m; planning takes 30 bytes a node
  const octomap::OcTree& tree = impl_->tree;
  const double resolution = tree.getResolution();
  Rectangle extent = area;
  if (tree.size() > 0)
  {
    double x = 0.0, y = 0.0, z = 0.0;
    tree.getMetricMin(x, y, z);
    extent.x_min = std::min(extent.x_min, x);
    extent.y_min = std::min(extent.y_min, y);
    tree.getMetricMax(x, y, z);
    extent.x_max = std::max(extent.x_max, x);
    extent.y_max = std::max(extent.y_max, y);
  }
  if (!(extent.width() / resolution * (extent.height() / resolution) <= kMaxNodes))
    throw InvalidArgument("the map is " + std::to_string(extent.width()) + " m x " +
                          std::to_string(extent.height()) + " m in nodes of " +
                          std::to_string(resolution) + " m: more than 25 million");
  // Grid nodes coincide with the tree's nodes, whose borders are multiples of the resolution.
  const int first_column = static_cast<int>(std::floor(extent.x_min / resolution + 1e-6));
  const int first_row = static_cast<int>(std::floor(extent.y_min / resolution + 1e-6));
  OccupancyGrid grid;
  grid.geometry.resolution_m = resolution;
  grid.geometry.origin = {first_column * resolution, first_row * resolution};
  grid.geometry.width =
      static_cast<int>(std::ceil(extent.x_max / resolution - 1e-6)) - first_column;
  grid.geometry.height = static_cast<int>(std::ceil(extent.y_max / resolution - 1e-6)) - first_row;
  grid.nodes.assign(grid.geometry.size(), Occupancy::kUnknown);
  if (tree.size() == 0)
    return grid;

  for (auto leaf = tree.begin_leafs(), end = tree.end_leafs(); leaf != end; ++leaf)
  {
    const double half = leaf.getSize() / 2.0;
    if (leaf.getZ() + half <= z_min_m || leaf.getZ() - half >= z_max_m)
      continue;
    const Occupancy value = tree.isNodeOccupied(*leaf) ? Occupancy::kOccupied : Occupancy::kFree;
    const int count = static_cast<int>(std::lround(leaf.getSize() / resolution));
    const int column =
        static_cast<int>(std::lround((leaf.getX() - half) / resolution)) - first_column;
    const int row = static_cast<int>(std::lround((leaf.getY() - half) / resolution)) - first_row;
    for (int r = row; r < row + count; ++r)
    {
      for (int c = column; c < column + count; ++c)
      {
        if (!grid.geometry.isInside(c, r))
          continue;
        Occupancy& node = grid.nodes[static_cast<std::size_t>(r * grid.geometry.width + c)];
        node = std::max(node, value);  // unknown < free < occupied
      }
    }
  }
  return grid;
}

std::vector<std::uint8_t> OccupancyMap::toBinary() const
{
  octomap::OcTree copy(
      impl_->tree);  // writing rounds the probabilities, which the living map must keep
  copy.toMaxLikelihood();
  copy.prune();
  std::ostringstream stream;
  // As OctoMap's writeBinary(), which also prints to the terminal.
  stream << "# Octomap OcTree binary file\n"
         << "id " << copy.getTreeType() << "\nsize " << copy.size() << "\nres "
         << copy.getResolution() << "\ndata\n";
  if (!copy.writeBinaryData(stream))
    throw InternalError("OctoMap could not serialise the map");
  const std::string bytes = stream.str();
  return {bytes.begin(), bytes.end()};
}

void OccupancyMap::save(const std::filesystem::path& path) const
{
  const std::vector<std::uint8_t> bytes = toBinary();
  const std::filesystem::path partial = path.string() + ".partial";
  {
    std::ofstream file(partial, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file)
      throw Unavailable("cannot write the map " + partial.string());
  }
  std::error_code error;
  std::filesystem::rename(partial, path, error);
  if (error)
    throw Unavailable("cannot write the map " + path.string() + ": " + error.message());
}

}  // namespace kr3::navigation
