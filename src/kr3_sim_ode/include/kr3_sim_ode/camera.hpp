#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kr3_sim_ode/building.hpp"
#include "kr3_sim_ode/object_model.hpp"
#include "kr3_sim_ode/placement.hpp"

namespace kr3::sim
{

/// A camera with square pixels and the principal point in the middle.
struct CameraModel
{
  int width = 640;
  int height = 480;
  double horizontal_fov_rad = 1.22;  ///< without the distortion
  /// Of the lens, plumb-bob model: k1, k2, p1, p2, k3, as in CameraInfo's D.
  std::array<double, 5> distortion{};

  [[nodiscard]] double focalLengthPixels() const;
};

/// Noise of one frame: exposure, then pixels.
struct CameraNoise
{
  double exposure_stddev = 0.03;  ///< of the factor on all pixels
  double pixel_stddev = 3.0;      ///< grey levels
};

/// Draws the building, headless (EGL surfaceless context in software, no display).
///
/// Not thread-safe: create, use and destroy it on one thread; its OpenGL context is current on that
/// thread meanwhile. Poses are of camera_link (x forward, y left, z up) in the world.
class Renderer
{
public:
  /// @throws Unavailable      no EGL context can be had
  /// @throws InvalidArgument  a texture cannot be read, or the lens cannot be simulated
  Renderer(const Building& building, std::vector<ObjectModel> models, const CameraModel& camera);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws the light of every place anew: brightness, tint and where the lamp hangs.
  void setLight(std::uint64_t seed);

  /// What the camera sees. @return CV_8UC3, BGR, height x width
  [[nodiscard]] cv::Mat image(const Pose& T_world_camera, const std::vector<ObjectState>& objects);

  /// Which object is at which pixel. @return CV_8UC1, height x width: index in `objects` plus one;
  /// 0 = none
  /// @throws InvalidArgument  more than 254 objects
  [[nodiscard]] cv::Mat mask(const Pose& T_world_camera, const std::vector<ObjectState>& objects);

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Applies exposure and pixel noise, cheap enough for every frame.
class ImageNoise
{
public:
  ImageNoise(const CameraModel& camera, const CameraNoise& noise, std::uint64_t seed);

  /// @param image  CV_8UC3, height x width of the camera; changed in place
  void apply(cv::Mat& image);

private:
  CameraNoise noise_;
  std::mt19937_64 generator_;
  cv::Mat pattern_;  // CV_16SC3, larger than an image: every frame adds another window of it
};

}  // namespace kr3::sim
