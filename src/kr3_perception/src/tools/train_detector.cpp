// Learns object models from folders of labelled images and writes them to one file.
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core/utility.hpp>

#include "kr3_common/error.hpp"
#include "kr3_perception/model_file.hpp"
#include "kr3_perception/object_list.hpp"
#include "kr3_perception/trainer.hpp"

namespace
{

std::vector<kr3::perception::LabelledFolder> open(const std::vector<std::string>& paths)
{
  std::vector<kr3::perception::LabelledFolder> folders;
  for (const std::string& path : paths)
    folders.emplace_back(path);
  return folders;
}

}  // namespace

int main(int argc, char** argv)
{
  std::vector<std::string> looks;
  std::vector<std::string> calibration;
  std::string objects;
  std::string out;
  kr3::perception::TrainerOptions options;
  CLI::App app("Learn object models from labelled images.");
  app.add_option("folders", looks, "labelled folders to learn looks from")->required();
  app.add_option(
      "--calibrate", calibration,
      "other labelled folders, to learn probabilities from (default: every third image)");
  app.add_option("--objects", objects,
                 "the domain's objects.yaml (default: whatever the labels name, sizes unknown)");
  app.add_option("--out", out, "model file to write, such as perception.yml.gz")->required();
  app.add_option("--views", options.views_per_object, "views kept per object")
      ->capture_default_str();
  app.add_option("--keypoints", options.keypoints_per_view, "local features kept per view")
      ->capture_default_str();
  app.add_option("--background", options.background_features, "local features of the building kept")
      ->capture_default_str();
  app.add_option("--features", options.detector.max_features, "local features per image")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  cv::setNumThreads(1);
  try
  {
    std::vector<kr3::perception::LabelledFolder> to_look_at = open(looks);
    std::vector<kr3::perception::LabelledFolder> to_calibrate = open(calibration);
    if (to_calibrate.empty())
      for (kr3::perception::LabelledFolder& folder : to_look_at)
      {
        auto [most, some] = folder.split(3);
        folder = std::move(most);
        to_calibrate.push_back(std::move(some));
      }
    const kr3::perception::Trainer trainer(objects.empty()
                                               ? kr3::perception::objectsOf(to_look_at)
                                               : kr3::perception::loadObjectList(objects),
                                           options);
    const kr3::perception::DetectorModel model = trainer.train(
        to_look_at, to_calibrate, [](const std::string& line) { std::cout << line << std::endl; });
    kr3::perception::saveModel(model, out);
    std::cout << "wrote " << out << ": " << model.objects.size() << " objects, "
              << model.views.size() << " views\n";
  }
  catch (const std::exception& e)
  {
    std::cerr << "train_detector: " << e.what() << '\n';
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
