// Says how good a map is: against the true one, and the rooms it shows against the building's
// labels.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <kr3_common/error.hpp>

#include "kr3_navigation/live_map.hpp"
#include "kr3_navigation/map_comparison.hpp"
#include "kr3_navigation/room_segmentation.hpp"

namespace
{

using namespace kr3::navigation;

nlohmann::json voxels(const OccupancyMap& map, const std::string& truth_path,
                      const MapComparisonOptions& options)
{
  const MapAgreement agreement = compareMaps(map, OccupancyMap::load(truth_path, {}), options);
  std::printf(
      "voxels (within %d): occupied precision %.4f, recall %.4f; free precision %.4f, recall "
      "%.4f\n",
      options.tolerance_nodes, agreement.occupiedPrecision(), agreement.occupiedRecall(),
      agreement.freePrecision(), agreement.freeRecall());
  return {{"tolerance", options.tolerance_nodes},
          {"occupied_precision", agreement.occupiedPrecision()},
          {"occupied_recall", agreement.occupiedRecall()},
          {"free_precision", agreement.freePrecision()},
          {"free_recall", agreement.freeRecall()}};
}

nlohmann::json rooms(const OccupancyMap& map, const std::string& building,
                     const SegmentationOptions& options)
{
  const std::vector<Place> places = loadPlaces(building);
  const LiveMapOptions band;
  const Segmentation segmentation =
      segmentRooms(map.project(band.z_min_m, band.z_max_m, areaOf(places, 0.0)), options);
  const SegmentationAgreement agreement = compareRooms(segmentation, places);
  std::printf(
      "rooms: %d segments for %zu places, mean IoU %.3f, %d places in several parts, %d "
      "segments for several places\n",
      segmentation.num_rooms, places.size(), agreement.mean_iou, agreement.over_segmented,
      agreement.under_segmented);
  nlohmann::json list = nlohmann::json::array();
  for (const PlaceAgreement& place : agreement.places)
  {
    std::printf("  %-20s IoU %.3f%s\n", place.place.c_str(), place.iou,
                place.num_parts > 1 ? ", in several parts" : "");
    list.push_back({{"place", place.place}, {"iou", place.iou}, {"parts", place.num_parts}});
  }
  return {{"segments", segmentation.num_rooms},
          {"mean_iou", agreement.mean_iou},
          {"over_segmented", agreement.over_segmented},
          {"under_segmented", agreement.under_segmented},
          {"places", list}};
}

}  // namespace

int main(int argc, char** argv)
{
  CLI::App app{"Compare a map with the true one, and its rooms with the building's labels."};
  std::string map_path;
  std::string truth;
  std::string building;
  std::string json_path;
  MapComparisonOptions comparison;
  SegmentationOptions segmentation;
  app.add_option("map", map_path, "OctoMap file (.bt)")->required();
  app.add_option("--truth", truth, "the world's own OctoMap (.bt)");
  app.add_option("--z-min", comparison.z_min_m, "lowest layer that is compared, m");
  app.add_option("--z-max", comparison.z_max_m, "upper border of the highest, m");
  app.add_option("--building", building, "building file (YAML) with the labels of rooms");
  app.add_option("--door-width", segmentation.door_width_m, "what is narrower joins rooms, m");
  app.add_option("--json", json_path, "write the figures there");
  CLI11_PARSE(app, argc, argv);
  try
  {
    const OccupancyMap map = OccupancyMap::load(map_path, {});
    nlohmann::json figures;
    if (!truth.empty())
    {
      for (const int tolerance : {0, 1})
      {
        comparison.tolerance_nodes = tolerance;
        figures["voxels"].push_back(voxels(map, truth, comparison));
      }
    }
    if (!building.empty())
      figures["rooms"] = rooms(map, building, segmentation);
    if (!json_path.empty() && !(std::ofstream(json_path) << figures.dump(1) << '\n'))
      throw kr3::Unavailable("cannot write " + json_path);
  }
  catch (const std::exception& e)
  {
    std::cerr << "check_map: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
