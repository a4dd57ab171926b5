// How fast the simulation runs: physics with laser and contacts, laser alone, camera, OctoMap.
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iomanip>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <sys/resource.h>

#include "kr3_sim_ode/camera.hpp"
#include "kr3_sim_ode/scenario.hpp"

namespace
{
using namespace kr3::sim;

constexpr int kStepsPerScan = 50;      // 10 Hz
constexpr int kStepsPerContacts = 10;  // 50 Hz
constexpr std::size_t kMaxPrintedName = 34;

/// CPU seconds of this process, all threads.
double cpuSeconds()
{
  rusage usage{};
  (void)getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Row
{
  std::string name;
  std::string unit;
  std::string better;
  std::optional<double> goal;
  std::vector<double> runs;

  [[nodiscard]] double median() const
  {
    std::vector<double> sorted = runs;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

class Bench
{
public:
  Bench(const Scenario& scenario, int num_runs, bool quick)
    : scenario_(scenario), num_runs_(num_runs), size_(quick ? 1 : 5)
  {
  }

  /// Drives in circles, bumping into things, with all sensors but the camera.
  void realTimeFactor()
  {
    const auto world = makeWorld(scenario_);
    world->setCommand(0.3, 0.4);
    const double seconds = 4.0 * size_;
    measure("simulator_real_time_factor", "simulated s per CPU s", "higher", 40.0, [&] {
      const auto steps = static_cast<int>(seconds / scenario_.world.time_step_s);
      const double before = cpuSeconds();
      for (int i = 0; i < steps; ++i)
      {
        world->step();
        if (i % kStepsPerScan == 0)
        {
          (void)world->scan();
        }
        if (i % kStepsPerContacts == 0)
        {
          (void)world->takeContacts();
        }
      }
      return seconds / (cpuSeconds() - before);
    });
  }

  void laser()
  {
    const auto world = makeWorld(scenario_);
    const int scans = 400 * size_;
    measure("simulator_laser_scans", "scans of 360 beams per CPU s", "higher", 4000.0, [&] {
      const double before = cpuSeconds();
      for (int i = 0; i < scans; ++i)
      {
        (void)world->scan();
      }
      return scans / (cpuSeconds() - before);
    });
  }

  void camera(int width, const std::array<double, 5>& distortion, double goal_ms)
  {
    CameraModel model;
    model.width = width;
    model.height = width * 3 / 4;
    model.distortion = distortion;
    Renderer renderer(scenario_.building, scenario_.models, model);
    ImageNoise noise(model, CameraNoise{}, scenario_.world.seed);
    const auto world = makeWorld(scenario_);
    const std::vector<ObjectState> objects = world->objects();
    const int frames = 8 * size_;
    const bool bends = distortion[0] != 0.0;
    measure("simulator_camera_" + std::to_string(width) + (bends ? "_distorted" : ""),
            "CPU ms a picture, noise included", "lower", goal_ms,
            [&] {
      const double before = cpuSeconds();
      for (int i = 0; i < frames; ++i)
      {
        Pose2 pose = scenario_.building.robot_start;
        pose.yaw += i * 6.28 / frames;
        cv::Mat image = renderer.image(poseOf(pose, 0.0) * RobotModel{}.T_base_camera(), objects);
        noise.apply(image);
      }
      return 1000.0 * (cpuSeconds() - before) / frames;
    });
  }

  void octomap()
  {
    const auto world = makeWorld(scenario_);
    measure("simulator_octomap", "CPU s at 0.1 m, 2 m high", "lower", std::nullopt, [&] {
      const double before = cpuSeconds();
      (void)world->octomap({});
      return cpuSeconds() - before;
    });
  }

  [[nodiscard]] nlohmann::json json() const
  {
    const nlohmann::json params{{"building", scenario_.building.name},
                                {"places", scenario_.building.places.size()},
                                {"objects", scenario_.building.objects.size()},
                                {"time_step_s", scenario_.world.time_step_s}};
    nlohmann::json rows = nlohmann::json::array();
    for (const Row& row : rows_)
    {
      nlohmann::json item{{"name", row.name},     {"value", row.median()}, {"unit", row.unit},
                          {"better", row.better}, {"params", params},      {"runs", row.runs}};
      item["goal"] = row.goal ? nlohmann::json(*row.goal) : nlohmann::json();
      rows.push_back(item);
    }
    return rows;
  }

  void print() const
  {
    for (const Row& row : rows_)
    {
      std::cout << std::left << std::setw(kMaxPrintedName) << row.name << std::right
                << std::setw(10) << std::setprecision(4) << row.median();
      std::cout << "  goal " << (row.goal ? std::to_string(static_cast<int>(*row.goal)) : "-")
                << "  " << row.unit << '\n';
    }
  }

private:
  void measure(const std::string& name, const std::string& unit, const std::string& better,
               std::optional<double> goal, const std::function<double()>& run)
  {
    Row row{name, unit, better, goal, {}};
    (void)run();  // warm
    for (int i = 0; i < num_runs_; ++i)
    {
      row.runs.push_back(run());
    }
    rows_.push_back(row);
  }

  Scenario scenario_;
  int num_runs_;
  int size_;
  std::vector<Row> rows_;
};
}  // namespace

int main(int argc, char** argv)
{
  std::string building;
  std::string objects;
  bool as_json = false;
  bool quick = false;
  int num_runs = 5;
  CLI::App app{"Measure the simulator in CPU time: medians, one row for each figure."};
  app.add_option("building", building, "building file (YAML)")->required();
  app.add_option("objects", objects, "objects file (YAML)")->required();
  app.add_option("--runs", num_runs, "runs of each row")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  app.add_flag("--json", as_json, "print the rows as a JSON list, with the runs");
  app.add_flag("--quick", quick, "a fifth of the work");
  CLI11_PARSE(app, argc, argv);
  try
  {
    Scenario scenario;
    scenario.building = loadBuilding(building);
    scenario.models = loadObjectModels(objects);
    Bench bench(scenario, num_runs, quick);
    bench.realTimeFactor();
    bench.laser();
    const std::array<double, 5> straight{};
    const std::array<double, 5> barrel{-0.2, 0.04, 0.0005, -0.0005, 0.0};
    bench.camera(640, straight, 18.0);
    bench.camera(640, barrel, 18.0);
    bench.camera(320, straight, 6.0);
    bench.camera(320, barrel, 6.0);
    bench.octomap();
    if (as_json)
    {
      std::cout << bench.json().dump(1) << '\n';
    }
    else
    {
      bench.print();
    }
  }
  catch (const std::exception& e)
  {
    std::cerr << "sim_bench: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
