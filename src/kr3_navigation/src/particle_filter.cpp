#include "kr3_navigation/particle_filter.hpp"

#include <algorithm>
#include <cmath>

#include <kr3_common/error.hpp>

namespace kr3::navigation
{

ParticleFilter::ParticleFilter(DistanceField field, const ParticleFilterOptions& options,
                               std::uint64_t seed, const std::vector<char>& movable)
  : options_(options), random_(seed)
{
  if (options_.num_particles < 1)
    throw InvalidArgument(std::to_string(options_.num_particles) +
                          " particles, expected at least 1");
  if (options_.beam_step < 1)
    throw InvalidArgument("beam step " + std::to_string(options_.beam_step) +
                          ", expected at least 1");
  if (!(options_.surface_m > 0.0 && options_.new_view_m > 0.0 && options_.new_view_rad > 0.0))
    throw InvalidArgument("surface_m, new_view_m and new_view_rad must be greater than 0");
  particles_.resize(static_cast<std::size_t>(options_.num_particles));
  setField(std::move(field), movable);
  reset(Pose{}, PoseSpread{});
}

void ParticleFilter::setField(DistanceField field, const std::vector<char>& movable)
{
  if (!movable.empty() && movable.size() != field.distance_m.size())
    throw InvalidArgument("movable has " + std::to_string(movable.size()) + " nodes, the map " +
                          std::to_string(field.distance_m.size()));
  field_ = std::move(field);
  const double exponent = -0.5 / (options_.hit_sigma_m * options_.hit_sigma_m);
  log_likelihood_.resize(field_.distance_m.size());
  std::transform(field_.distance_m.begin(), field_.distance_m.end(), log_likelihood_.begin(),
                 [&](float distance_m) {
    const auto d = static_cast<double>(distance_m);
    return static_cast<float>(std::log(std::exp(exponent * d * d) + options_.random_hit));
  });
  const auto floor = static_cast<float>(std::log(options_.random_hit));
  const auto weight = static_cast<float>(options_.movable_weight);
  for (std::size_t node = 0; node < movable.size(); ++node)
  {
    if (movable[node] != 0)
      log_likelihood_[node] = floor + weight * (log_likelihood_[node] - floor);
  }
}

double ParticleFilter::logLikelihood(Point p) const
{
  const GridGeometry& grid = field_.geometry;
  const double u = (p.x - grid.origin.x) / grid.resolution_m - 0.5;
  const double v = (p.y - grid.origin.y) / grid.resolution_m - 0.5;
  if (!(u >= 0.0 && v >= 0.0 && u < grid.width - 1 && v < grid.height - 1))
    return std::log(options_.random_hit);
  const int column = static_cast<int>(u);
  const int row = static_cast<int>(v);
  const auto a = static_cast<float>(u - column);
  const auto b = static_cast<float>(v - row);
  const float* low = &log_likelihood_[static_cast<std::size_t>(row * grid.width + column)];
  const float* high = low + grid.width;
  const float below = low[0] + a * (low[1] - low[0]);
  const float above = high[0] + a * (high[1] - high[0]);
  return static_cast<double>(below + b * (above - below));
}

void ParticleFilter::reset(const Pose& mean, const PoseSpread& spread)
{
  std::normal_distribution<double> normal;
  for (Particle& particle : particles_)
  {
    particle.pose = {mean.x + spread.position_m * normal(random_),
                     mean.y + spread.position_m * normal(random_),
                     wrapAngle(mean.yaw + spread.yaw_rad * normal(random_))};
    particle.weight = 1.0 / static_cast<double>(particles_.size());
  }
  new_view_ = 1.0;
  summarise();
}

void ParticleFilter::predict(const Pose& T_before_now)
{
  const double driven = std::hypot(T_before_now.x, T_before_now.y);
  const double turned = std::abs(T_before_now.yaw);
  new_view_ += driven / options_.new_view_m + turned / options_.new_view_rad;
  const double drive_sigma = options_.drive_noise * driven + options_.drive_floor_m +
                             0.02 * turned;  // wheels slip a little while turning
  const double turn_sigma = options_.turn_noise * turned + options_.turn_floor_rad +
                            0.03 * driven;  // and pull aside while driving
  std::normal_distribution<double> normal;
  for (Particle& particle : particles_)
  {
    const double scale = driven > 1e-6 ? 1.0 + drive_sigma * normal(random_) / driven : 1.0;
    Pose step{T_before_now.x * scale, T_before_now.y * scale,
              T_before_now.yaw + turn_sigma * normal(random_)};
    if (driven <= 1e-6)
      step.x += drive_sigma * normal(random_);
    // The heading halfway is the best guess for the direction of the noise.
    const Pose half{0.0, 0.0, (step.yaw - T_before_now.yaw) / 2.0};
    particle.pose = particle.pose * half * Pose{step.x, step.y, step.yaw - half.yaw};
  }
  summarise();
}

std::vector<ParticleFilter::WeightedHit> ParticleFilter::takeHits(const LaserScan& scan,
                                                                  const Pose& T_base_laser)
{
  const double spacing_rad =
      std::abs(scan.angle_increment_rad) * static_cast<double>(options_.beam_step);
  std::vector<WeightedHit> hits;
  for (std::size_t beam = static_cast<std::size_t>(first_beam_); beam < scan.ranges_m.size();
       beam += static_cast<std::size_t>(options_.beam_step))
  {
    if (!scan.isHit(beam))
      continue;
    const double surface_m = static_cast<double>(scan.ranges_m[beam]) * spacing_rad;
    hits.push_back(
        {T_base_laser * scan.endpoint(beam), std::min(1.0, surface_m / options_.surface_m)});
  }
  first_beam_ = (first_beam_ + 1) % options_.beam_step;
  return hits;
}

void ParticleFilter::update(const LaserScan& scan, const Pose& T_base_laser)
{
  const std::vector<WeightedHit> hits = takeHits(scan, T_base_laser);
  if (hits.empty())
    return;
  const double power = options_.likelihood_power * std::min(1.0, new_view_ + options_.view_at_rest);
  new_view_ = 0.0;

  const double far_m = 10.0 * options_.hit_sigma_m;
  std::vector<double> log_weights(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i)
  {
    const Pose& pose = particles_[i].pose;
    const double c = std::cos(pose.yaw);
    const double s = std::sin(pose.yaw);
    double log_likelihood = 0.0;
    for (const WeightedHit& hit : hits)
      log_likelihood += hit.weight * logLikelihood({pose.x + c * hit.p_base.x - s * hit.p_base.y,
                                                    pose.y + s * hit.p_base.x + c * hit.p_base.y});
    log_weights[i] = std::log(particles_[i].weight) + power * log_likelihood;
  }
  const double best = *std::max_element(log_weights.begin(), log_weights.end());
  double sum = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i)
  {
    particles_[i].weight = std::exp(log_weights[i] - best);
    sum += particles_[i].weight;
  }
  double sum_of_squares = 0.0;
  for (Particle& particle : particles_)
  {
    particle.weight /= sum;
    sum_of_squares += particle.weight * particle.weight;
  }
  summarise();
  double total_distance = 0.0;
  for (const WeightedHit& hit : hits)
    total_distance += std::min(far_m, field_.at(estimate_.mean * hit.p_base, far_m));
  estimate_.mean_hit_distance_m = total_distance / static_cast<double>(hits.size());
  if (1.0 / sum_of_squares < static_cast<double>(particles_.size()) / 2.0)
    resample();
  // A weight of zero would be log 0 for ever.
  for (Particle& particle : particles_)
    particle.weight = std::max(particle.weight, 1e-300);
}

void ParticleFilter::resample()
{
  // Low-variance sampling, Table 4.4.
  const double step = 1.0 / static_cast<double>(particles_.size());
  double pointer = std::uniform_real_distribution<double>(0.0, step)(random_);
  std::vector<Particle> drawn;
  drawn.reserve(particles_.size());
  std::size_t source = 0;
  double cumulative = particles_[0].weight;
  for (std::size_t i = 0; i < particles_.size(); ++i, pointer += step)
  {
    while (pointer > cumulative && source + 1 < particles_.size())
      cumulative += particles_[++source].weight;
    drawn.push_back({particles_[source].pose, step});
  }
  particles_ = std::move(drawn);
}

void ParticleFilter::summarise()
{
  Pose mean;
  double cos_sum = 0.0;
  double sin_sum = 0.0;
  for (const Particle& particle : particles_)
  {
    mean.x += particle.weight * particle.pose.x;
    mean.y += particle.weight * particle.pose.y;
    cos_sum += particle.weight * std::cos(particle.pose.yaw);
    sin_sum += particle.weight * std::sin(particle.pose.yaw);
  }
  mean.yaw = std::atan2(sin_sum, cos_sum);
  std::array<double, 9> covariance{};
  for (const Particle& particle : particles_)
  {
    const std::array<double, 3> deviation{particle.pose.x - mean.x, particle.pose.y - mean.y,
                                          wrapAngle(particle.pose.yaw - mean.yaw)};
    for (std::size_t row = 0; row < 3; ++row)
    {
      for (std::size_t column = 0; column < 3; ++column)
        covariance[3 * row + column] += particle.weight * deviation[row] * deviation[column];
    }
  }
  // The nodes of the map round its walls: an error that all beams share and no particle shows.
  constexpr double kMapError = 0.1;  // of the resolution, standard deviation
  const double map_variance = std::pow(kMapError * field_.geometry.resolution_m, 2.0);
  covariance[0] += map_variance;
  covariance[4] += map_variance;
  estimate_.mean = mean;
  estimate_.covariance = covariance;
}

double ParticleFilter::probabilityIn(const Rectangle& area) const
{
  double probability = 0.0;
  for (const Particle& particle : particles_)
  {
    if (area.contains(particle.pose.position()))
      probability += particle.weight;
  }
  return std::min(1.0, probability);
}

}  // namespace kr3::navigation
