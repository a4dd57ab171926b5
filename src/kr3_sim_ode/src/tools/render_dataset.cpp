// Renders labelled pictures of a building's objects, for training and testing perception.
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <kr3_common/error.hpp>

#include "../dataset.hpp"
#include "kr3_sim_ode/camera.hpp"
#include "kr3_sim_ode/random.hpp"

namespace
{
using namespace kr3::sim;

struct Options
{
  std::string building;
  std::string objects;
  std::string out;
  int count = 200;
  int background_every = 10;
  std::uint64_t seed = 1;
  CameraModel camera;
  CameraNoise noise;
  SceneOptions scene;
  RobotModel robot;
};

Options parse(int argc, char** argv)
{
  Options options;
  CLI::App app{"Render labelled pictures: OUT/00000.png, OUT/00000_mask.png and OUT/labels.json."};
  app.set_help_flag("--help", "print this");
  app.add_option("building", options.building, "building file (YAML)")->required();
  app.add_option("objects", options.objects, "objects file (YAML)")->required();
  app.add_option("out", options.out, "directory, made when missing")->required();
  app.add_option("-n,--count", options.count, "pictures")
      ->check(CLI::Range(1, 99999))
      ->capture_default_str();
  app.add_option("-s,--seed", options.seed, "seed")->capture_default_str();
  app.add_option("--background-every", options.background_every,
                 "every so many pictures one that looks anywhere (0: none)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--width", options.camera.width, "pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app.add_option("--height", options.camera.height, "pixels")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  app.add_option("--hfov", options.camera.horizontal_fov_rad, "rad")
      ->check(CLI::Range(0.1, 3.0))
      ->capture_default_str();
  app.add_option("--camera-pitch", options.robot.camera_pitch_rad, "rad, positive looks down")
      ->capture_default_str();
  app.add_option("--min-distance", options.scene.min_distance_m, "m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-distance", options.scene.max_distance_m, "m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--crowd", options.scene.crowd,
                 "so many objects, close together on one piece of furniture (0: all, scattered)")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--turn", options.scene.max_turn_rad, "objects are turned by up to so much, rad")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--exposure-noise", options.noise.exposure_stddev,
                 "standard deviation of a picture's exposure factor")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  try
  {
    app.parse(argc, argv);
  }
  catch (const CLI::ParseError& e)
  {
    std::exit(app.exit(e));
  }
  return options;
}

void write(const std::filesystem::path& path, const cv::Mat& image)
{
  if (!cv::imwrite(path.string(), image))
  {
    throw kr3::Unavailable("cannot write '" + path.string() + "'");
  }
}

/// What the mask shows: one entry per object with at least one pixel.
nlohmann::json labels(const LabelledView& view, const std::vector<ObjectModel>& models,
                      const cv::Mat& mask, const Pose& T_world_camera)
{
  nlohmann::json result = nlohmann::json::array();
  for (std::size_t i = 0; i < view.objects.size(); ++i)
  {
    const cv::Mat pixels = mask == static_cast<double>(i + 1);
    const int count = cv::countNonZero(pixels);
    if (count == 0)
    {
      continue;
    }
    const cv::Rect box = cv::boundingRect(pixels);
    const ObjectState& object = view.objects[i];
    const Vector3& p = object.pose.position;
    const Vector3& c = T_world_camera.position;
    const double bearing = std::atan2(c.y - p.y, c.x - p.x);
    result.push_back({{"name", object.name},
                      {"class", findModel(models, object.model).class_name},
                      {"instance", i + 1},
                      {"box", {box.x, box.y, box.width, box.height}},
                      {"pixels", count},
                      {"distance", std::hypot(p.x - c.x, p.y - c.y, p.z - c.z)},
                      {"view_angle", wrapped(bearing - yawOf(object.pose.orientation))}});
  }
  return result;
}

void render(const Options& options)
{
  const Building building = loadBuilding(options.building);
  const std::vector<ObjectModel> models = loadObjectModels(options.objects);
  std::filesystem::create_directories(options.out);
  Renderer renderer(building, models, options.camera);
  ImageNoise noise(options.camera, options.noise, options.seed);
  std::mt19937_64 generator = makeGenerator(options.seed, Stream::kDataset);
  nlohmann::json images = nlohmann::json::array();
  for (int i = 0; i < options.count; ++i)
  {
    const bool background = options.background_every > 0 &&
                            i % options.background_every == options.background_every - 1;
    const LabelledView view =
        drawView(building, models, options.robot, options.scene, background, generator);
    renderer.setLight(generator());
    const Pose T_world_camera = poseOf(view.T_world_base, 0.0) * options.robot.T_base_camera();
    cv::Mat image = renderer.image(T_world_camera, view.objects);
    noise.apply(image);
    const cv::Mat mask = renderer.mask(T_world_camera, view.objects);
    std::ostringstream stem;
    stem << std::setw(5) << std::setfill('0') << i;
    write(std::filesystem::path(options.out) / (stem.str() + ".png"), image);
    write(std::filesystem::path(options.out) / (stem.str() + "_mask.png"), mask);
    images.push_back({{"image", stem.str() + ".png"},
                      {"mask", stem.str() + "_mask.png"},
                      {"objects", labels(view, models, mask, T_world_camera)}});
  }
  const nlohmann::json all{{"building", building.name},
                           {"seed", options.seed},
                           {"width", options.camera.width},
                           {"height", options.camera.height},
                           {"horizontal_fov", options.camera.horizontal_fov_rad},
                           {"images", images}};
  std::ofstream file(std::filesystem::path(options.out) / "labels.json");
  file << all.dump(1) << '\n';
  if (!file.flush())
  {
    throw kr3::Unavailable("cannot write '" + options.out + "/labels.json'");
  }
}
}  // namespace

int main(int argc, char** argv)
{
  const Options options = parse(argc, argv);
  try
  {
    render(options);
  }
  catch (const std::exception& e)
  {
    std::cerr << "render_dataset: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
