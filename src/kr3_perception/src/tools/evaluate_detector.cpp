// Tells how good a detector model is on labelled images that it has not seen.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include "kr3_common/error.hpp"
#include "kr3_perception/drawing.hpp"
#include "kr3_perception/evaluation.hpp"
#include "kr3_perception/model_file.hpp"
#include "kr3_perception/reliability_diagram.hpp"

namespace
{

using namespace kr3::perception;

struct Options
{
  std::string model;
  std::vector<std::string> folders;
  std::string draw;
  std::string diagram;
  std::string json;
  bool by_object = false;
  double threshold = 0.5;
  int min_pixels = 250;
  double match_overlap = 0.4;
  DetectorOptions detector;
};

struct Result
{
  std::string name;
  Evaluation evaluation;
  std::vector<double> cpu_ms;  ///< per image, ascending

  [[nodiscard]] double quantile(double share) const
  {
    return cpu_ms[std::min(cpu_ms.size() - 1,
                           static_cast<std::size_t>(share * static_cast<double>(cpu_ms.size())))];
  }
};

void write(const std::string& path, const cv::Mat& picture)
{
  if (!cv::imwrite(path, picture))
    throw kr3::Unavailable("cannot write '" + path + "'");
}

Result evaluate(const Options& options, const Detector& detector, const std::string& path)
{
  std::map<std::string, std::string> class_of;
  for (const ObjectDescription& object : detector.model().objects)
    class_of[object.name] = object.class_name;
  const std::string name = std::filesystem::path(path).lexically_normal().filename().string();
  Result result{name, {options.threshold, options.min_pixels, options.match_overlap}, {}};
  const LabelledFolder folder(path);
  for (std::size_t i = 0; i < folder.size(); ++i)
  {
    LabelledImage image = folder.image(i);
    const std::clock_t start = std::clock();  // CPU time: others may use the machine
    const std::vector<Detection> detections = detector.detect(image.bgr);
    result.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    result.evaluation.add(detections, image.labels, class_of);
    if (options.draw.empty())
      continue;
    std::vector<Detection> likely;
    for (const Detection& detection : detections)
      if (detection.probability >= options.threshold)
        likely.push_back(detection);
    draw(image.bgr, likely);
    char number[32];
    std::snprintf(number, sizeof number, "_%05zu.png", i);
    write(options.draw + "/" + name + number, image.bgr);
  }
  std::sort(result.cpu_ms.begin(), result.cpu_ms.end());
  return result;
}

void printScore(const std::string& name, const ClassScore& score)
{
  std::printf("  %-16s precision %.3f  recall %.3f  (right %d, wrong %d, missed %d)\n",
              name.c_str(), score.precision(), score.recall(), score.right, score.wrong,
              score.missed);
}

void print(const Result& result, bool by_object)
{
  std::printf("%s: %zu images\n", result.name.c_str(), result.cpu_ms.size());
  for (const auto& [name, score] : result.evaluation.classes())
    printScore(name, score);
  if (by_object)
    for (const auto& [name, score] : result.evaluation.objects())
      printScore("- " + name, score);
  printScore("all", result.evaluation.total());
  std::printf("  Brier score %.4f\n  said -> right:", result.evaluation.brier());
  for (const ReliabilityBin& bin : result.evaluation.reliability())
    if (bin.detections > 0)
      std::printf("  %.2f -> %.2f (%d)", bin.probability_sum / bin.detections,
                  static_cast<double>(bin.right) / bin.detections, bin.detections);
  std::printf("\n  CPU ms per frame: median %.1f, 95 %% %.1f\n", result.quantile(0.5),
              result.quantile(0.95));
}

nlohmann::json toJson(const ClassScore& score)
{
  return {{"precision", score.precision()},
          {"recall", score.recall()},
          {"right", score.right},
          {"wrong", score.wrong},
          {"missed", score.missed}};
}

nlohmann::json toJson(const Result& result)
{
  const auto to_json = [](const std::map<std::string, ClassScore>& scores) {
    nlohmann::json all = nlohmann::json::object();
    for (const auto& [name, score] : scores)
      all[name] = toJson(score);
    return all;
  };
  nlohmann::json reliability = nlohmann::json::array();
  for (const ReliabilityBin& bin : result.evaluation.reliability())
    reliability.push_back(
        {{"detections", bin.detections},
         {"right", bin.right},
         {"mean_probability", bin.detections > 0 ? bin.probability_sum / bin.detections : 0.0}});
  return {{"set", result.name},
          {"images", result.cpu_ms.size()},
          {"all", toJson(result.evaluation.total())},
          {"classes", to_json(result.evaluation.classes())},
          {"objects", to_json(result.evaluation.objects())},
          {"brier", result.evaluation.brier()},
          {"reliability", reliability},
          {"cpu_ms", {{"median", result.quantile(0.5)}, {"p95", result.quantile(0.95)}}}};
}

void run(const Options& options)
{
  const Detector detector(loadModel(options.model), options.detector);
  if (!options.draw.empty())
    std::filesystem::create_directories(options.draw);
  if (!options.diagram.empty())
    std::filesystem::create_directories(options.diagram);
  nlohmann::json sets = nlohmann::json::array();
  for (const std::string& path : options.folders)
  {
    const Result result = evaluate(options, detector, path);
    print(result, options.by_object);
    sets.push_back(toJson(result));
    if (!options.diagram.empty())
      write(options.diagram + "/reliability_" + result.name + ".png",
            reliabilityDiagram(result.evaluation, result.name));
  }
  if (options.json.empty())
    return;
  std::ofstream file(options.json);
  file << nlohmann::json{{"model", options.model},
                         {"threshold", options.threshold},
                         {"min_pixels", options.min_pixels},
                         {"match_overlap", options.match_overlap},
                         {"sets", sets}}
              .dump(1)
       << '\n';
  if (!file.flush())
    throw kr3::Unavailable("cannot write '" + options.json + "'");
}

}  // namespace

int main(int argc, char** argv)
{
  Options options;
  CLI::App app("Evaluate a detector model on labelled images, one folder after the other.");
  app.add_option("model", options.model, "model file")->required();
  app.add_option("folders", options.folders, "labelled folders")->required();
  app.add_option("--threshold", options.threshold, "probability from which a detection counts")
      ->capture_default_str();
  app.add_option("--min-pixels", options.min_pixels, "smaller objects do not count")
      ->capture_default_str();
  app.add_option("--overlap", options.match_overlap,
                 "intersection over union that makes a detection right")
      ->capture_default_str();
  app.add_option("--features", options.detector.max_features, "local features per image")
      ->capture_default_str();
  app.add_option("--checks", options.detector.search_checks, "leaves visited per feature")
      ->capture_default_str();
  app.add_option("--instances", options.detector.max_instances,
                 "of one object an image; 0: as many as training showed")
      ->capture_default_str();
  app.add_flag("--by-object", options.by_object, "also print each object's figures");
  app.add_option("--draw", options.draw, "folder for pictures with detections");
  app.add_option("--diagrams", options.diagram, "folder for reliability diagrams");
  app.add_option("--json", options.json, "file for all figures");
  CLI11_PARSE(app, argc, argv);
  options.detector.min_probability = 0.0;  // the Brier score is over all detections
  cv::setNumThreads(1);
  try
  {
    run(options);
  }
  catch (const std::exception& e)
  {
    std::cerr << "evaluate_detector: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
