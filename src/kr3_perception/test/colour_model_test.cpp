#include "kr3_perception/colour_model.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <kr3_common/error.hpp>

namespace kr3::perception
{
namespace
{

cv::Mat plain(const cv::Scalar& bgr, int conversion)
{
  cv::Mat result;
  cv::cvtColor(cv::Mat(40, 40, CV_8UC3, bgr), result, conversion);
  return result;
}

const cv::Scalar kGrey(200, 200, 200);
const cv::Scalar kRed(20, 20, 200);
const cv::Scalar kBlue(200, 40, 20);

TEST(ColourHistogram, SumsToOneAndIsZeroWithoutPixels)
{
  const cv::Mat hsv = plain(kRed, cv::COLOR_BGR2HSV);
  EXPECT_NEAR(cv::sum(colourHistogram(hsv))[0], 1.0, 1e-6);
  EXPECT_EQ(cv::sum(colourHistogram(hsv, cv::Mat::zeros(hsv.size(), CV_8U)))[0], 0.0);
}

TEST(Bhattacharyya, IsZeroForTheSameAndOneForDisjointHistograms)
{
  const cv::Mat red = colourHistogram(plain(kRed, cv::COLOR_BGR2HSV));
  const cv::Mat blue = colourHistogram(plain(kBlue, cv::COLOR_BGR2HSV));
  EXPECT_NEAR(bhattacharyya(red, red), 0.0, 1e-3);
  EXPECT_NEAR(bhattacharyya(red, blue), 1.0, 1e-6);
  EXPECT_DOUBLE_EQ(bhattacharyya(red, blue), bhattacharyya(blue, red));
}

TEST(ColourCounter, TellsObjectsFromTheBuildingAndFromEachOther)
{
  ColourCounter counter(2);
  const auto count = [&](const cv::Scalar& colour, int who) {
    counter.add(plain(colour, cv::COLOR_BGR2Lab), cv::Mat(40, 40, CV_32S, cv::Scalar(who)));
  };
  count(kGrey, -1);
  count(kRed, 0);
  count(kBlue, 1);
  const ForegroundModel foreground = counter.foreground();
  const ObjectColourModel objects = counter.objects();
  const cv::Mat everywhere(40, 40, CV_8U, cv::Scalar(255));
  EXPECT_EQ(cv::countNonZero(foreground.segment(plain(kGrey, cv::COLOR_BGR2Lab))), 0);
  // A red square before a wall, be its colour known or not.
  for (const cv::Scalar& wall : {kGrey, cv::Scalar(30, 200, 30)})
  {
    cv::Mat image = plain(wall, cv::COLOR_BGR2Lab);
    plain(kRed, cv::COLOR_BGR2Lab)(cv::Rect(0, 0, 6, 6)).copyTo(image(cv::Rect(5, 5, 6, 6)));
    const cv::Mat found = foreground.segment(image);
    EXPECT_EQ(cv::countNonZero(found), 36);
    EXPECT_EQ(cv::countNonZero(found(cv::Rect(5, 5, 6, 6))), 36);
  }
  const std::vector<cv::Mat> masks = objects.segment(plain(kBlue, cv::COLOR_BGR2Lab), everywhere);
  EXPECT_EQ(cv::countNonZero(masks[0]), 0);
  EXPECT_EQ(cv::countNonZero(masks[1]), 40 * 40);
}

TEST(ColourCounter, NeedsTheBuilding)
{
  ColourCounter counter(1);
  counter.add(plain(kRed, cv::COLOR_BGR2Lab), cv::Mat::zeros(40, 40, CV_32S));
  EXPECT_THROW((void)counter.foreground(), FailedPrecondition);
}

TEST(ForegroundModel, RejectsTablesOfTheWrongShape)
{
  EXPECT_THROW(ForegroundModel(cv::Mat::zeros(2, 7, CV_32F)), InvalidArgument);
  EXPECT_THROW(ForegroundModel(cv::Mat::zeros(2, ForegroundModel::kBins, CV_8U)), InvalidArgument);
  EXPECT_THROW(ObjectColourModel(cv::Mat::zeros(2, 7, CV_8U)), InvalidArgument);
}

}  // namespace
}  // namespace kr3::perception
