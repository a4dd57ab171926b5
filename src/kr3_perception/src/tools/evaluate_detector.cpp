// Prints how good a detector model is on labelled images that it has not seen.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "kr3_common/error.hpp"
#include "kr3_perception/drawing.hpp"
#include "kr3_perception/evaluation.hpp"
#include "kr3_perception/model_file.hpp"

namespace
{

void print(const std::string& name, const kr3::perception::ClassScore& score)
{
  std::printf("%-16s precision %.3f  recall %.3f  (right %d, wrong %d, missed %d)\n", name.c_str(),
              score.precision(), score.recall(), score.right, score.wrong, score.missed);
}

}  // namespace

int main(int argc, char** argv)
{
  std::string model_path;
  std::vector<std::string> folder_paths;
  std::string draw_to;
  double threshold = 0.5;
  int min_pixels = 250;
  double match_overlap = 0.4;
  kr3::perception::DetectorOptions options;
  CLI::App app("Evaluate a detector model on labelled images.");
  app.add_option("model", model_path, "model file")->required();
  app.add_option("folders", folder_paths, "labelled folders")->required();
  app.add_option("--threshold", threshold, "probability from which a detection counts")
      ->capture_default_str();
  app.add_option("--min-pixels", min_pixels, "smaller objects do not count")->capture_default_str();
  app.add_option("--overlap", match_overlap, "intersection over union that makes a detection right")
      ->capture_default_str();
  app.add_option("--features", options.max_features, "local features per image")
      ->capture_default_str();
  app.add_option("--checks", options.search_checks, "leaves visited per feature")
      ->capture_default_str();
  app.add_option("--draw", draw_to, "folder for pictures with detections");
  CLI11_PARSE(app, argc, argv);
  options.min_probability = 0.05;
  cv::setNumThreads(1);
  try
  {
    using Clock = std::chrono::steady_clock;
    const kr3::perception::Detector detector(kr3::perception::loadModel(model_path), options);
    kr3::perception::Evaluation evaluation(threshold, min_pixels, match_overlap);
    std::map<std::string, std::string> class_of;
    for (const kr3::perception::ObjectDescription& object : detector.model().objects)
      class_of[object.name] = object.class_name;
    std::vector<double> times_ms;
    if (!draw_to.empty())
      std::filesystem::create_directories(draw_to);
    for (const std::string& folder_path : folder_paths)
    {
      const kr3::perception::LabelledFolder folder(folder_path);
      for (std::size_t i = 0; i < folder.size(); ++i)
      {
        kr3::perception::LabelledImage image = folder.image(i);
        const Clock::time_point start = Clock::now();
        const std::vector<kr3::perception::Detection> detections = detector.detect(image.bgr);
        times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
        evaluation.add(detections, image.labels, class_of);
        if (draw_to.empty())
          continue;
        kr3::perception::draw(image.bgr, detections);
        const std::string name = draw_to + "/" +
                                 std::filesystem::path(folder_path).filename().string() + "_" +
                                 std::filesystem::path(image.name).stem().string() + ".png";
        if (!cv::imwrite(name, image.bgr))
          throw kr3::Unavailable("cannot write '" + name + "'");
      }
    }
    for (const auto& [name, score] : evaluation.classes())
      print(name, score);
    print("all", evaluation.total());
    std::printf("Brier score %.4f\nreliability (probability said -> share right):",
                evaluation.brier());
    for (const kr3::perception::ReliabilityBin& bin : evaluation.reliability())
      if (bin.detections > 0)
        std::printf("  %.2f -> %.2f (%d)", bin.probability_sum / bin.detections,
                    static_cast<double>(bin.right) / bin.detections, bin.detections);
    std::sort(times_ms.begin(), times_ms.end());
    if (!times_ms.empty())
      std::printf("\nms per frame: median %.1f, 95 %% %.1f\n", times_ms[times_ms.size() / 2],
                  times_ms[times_ms.size() * 95 / 100]);
  }
  catch (const std::exception& e)
  {
    std::cerr << "evaluate_detector: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
