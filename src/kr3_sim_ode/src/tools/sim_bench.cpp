// How fast the simulation runs: physics, laser and camera, alone and together.
// usage: sim_bench BUILDING OBJECTS [Google Benchmark options]
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>
#include <opencv2/core/mat.hpp>

#include "kr3_sim_ode/camera.hpp"
#include "kr3_sim_ode/scenario.hpp"

namespace
{
using namespace kr3::sim;

Scenario scenarioFrom(const std::string& building, const std::string& objects)
{
  Scenario scenario;
  scenario.building = loadBuilding(building);
  scenario.models = loadObjectModels(objects);
  return scenario;
}

/// One simulated second of driving in circles, with a scan every 0.1 s and `frames` pictures.
void simulateSecond(World& world, Renderer* renderer, ImageNoise* noise, int frames)
{
  const int steps = 500;
  for (int i = 0; i < steps; ++i)
  {
    world.step();
    if (i % 50 == 0)
    {
      benchmark::DoNotOptimize(world.scan());
    }
    if (frames > 0 && i % (steps / frames) == 0)
    {
      cv::Mat image =
          renderer->image(world.robotPose() * RobotModel{}.T_base_camera(), world.objects());
      noise->apply(image);
      benchmark::DoNotOptimize(image.data);
    }
  }
}

void realTimeFactor(benchmark::State& state, const Scenario& scenario, int width, int frames)
{
  const auto world = makeWorld(scenario);
  const CameraModel camera{width, width * 3 / 4, 1.22};
  std::unique_ptr<Renderer> renderer;
  std::unique_ptr<ImageNoise> noise;
  if (frames > 0)
  {
    renderer = std::make_unique<Renderer>(scenario.building, scenario.models, camera);
    noise = std::make_unique<ImageNoise>(camera, CameraNoise{}, scenario.world.seed);
  }
  world->setCommand(0.3, 0.6);
  for (const auto _ : state)
  {
    (void)_;
    simulateSecond(*world, renderer.get(), noise.get(), frames);
  }
  state.counters["real_time_factor"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
}  // namespace

int main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  if (argc != 3)
  {
    std::cerr << "usage: sim_bench BUILDING OBJECTS [--benchmark_...]\n";
    return EXIT_FAILURE;
  }
  try
  {
    const Scenario scenario = scenarioFrom(argv[1], argv[2]);
    const auto add = [&](const std::string& name, int width, int frames) {
      benchmark::RegisterBenchmark(
          name.c_str(),
          [=](benchmark::State& state) { realTimeFactor(state, scenario, width, frames); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    };
    add("physics_laser", 640, 0);
    add("physics_laser_camera_640_5hz", 640, 5);
    add("physics_laser_camera_320_5hz", 320, 5);
    benchmark::RunSpecifiedBenchmarks();
  }
  catch (const std::exception& e)
  {
    std::cerr << "sim_bench: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
