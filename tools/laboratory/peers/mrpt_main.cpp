// SPDX-License-Identifier: Apache-2.0
/// strata-peer-mrpt JOB.json RESULT.json: MRPT's particle filter on a job of `strata compare
/// --peers`. Its likelihood field, motion model and resampling have MRPT's own defaults; map,
/// scans, start, seed and number of particles are those of our models. MRPT resamples within its
/// update, so its error is that of the resampled particles.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>

#include <Eigen/Cholesky>
#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CMonteCarloLocalization2D.h>

#include "core/geometry/angle.hpp"
#include "tools/laboratory/peers/peer_job.hpp"

namespace strata::peers {
namespace {

using mrpt::maps::COccupancyGridMap2D;
using mrpt::slam::CMonteCarloLocalization2D;

COccupancyGridMap2D::Ptr make_map(const PeerMap& given) {
  auto map = COccupancyGridMap2D::Create();
  const int height = static_cast<int>(given.cells.size()) / given.width;
  map->setSize(static_cast<float>(given.origin_x_m),
               static_cast<float>(given.origin_x_m + given.width * given.resolution_m),
               static_cast<float>(given.origin_y_m),
               static_cast<float>(given.origin_y_m + height * given.resolution_m),
               static_cast<float>(given.resolution_m), 0.5F);
  for (std::size_t i = 0; i < given.cells.size(); ++i) {
    const int x = static_cast<int>(i) % given.width;
    const int y = static_cast<int>(i) / given.width;
    // By metres: setSize may round the corner to whole cells.
    const int cell_x = map->x2idx(given.origin_x_m + (x + 0.5) * given.resolution_m);
    const int cell_y = map->y2idx(given.origin_y_m + (y + 0.5) * given.resolution_m);
    const float free_probability = given.cells[i] == PeerMap::kFree       ? 0.99F
                                   : given.cells[i] == PeerMap::kOccupied ? 0.01F
                                                                          : 0.5F;
    map->setCell(cell_x, cell_y, free_probability);
  }
  return map;
}

void draw_start(const PeerJob& job, CMonteCarloLocalization2D& filter) {
  auto& random = mrpt::random::getRandomGenerator();
  random.randomize(static_cast<std::uint32_t>(job.seed));
  const Eigen::Matrix3d root = job.start.covariance.llt().matrixL();
  for (auto& particle : filter.m_particles) {
    const Eigen::Vector3d unit(random.drawGaussian1D_normalized(),
                               random.drawGaussian1D_normalized(),
                               random.drawGaussian1D_normalized());
    const Eigen::Vector3d off = root * unit;
    particle.d = {job.start.mean.x + off.x(), job.start.mean.y + off.y(),
                  job.start.mean.theta + off.z()};
    particle.log_w = 0.0;
  }
}

mrpt::obs::CSensoryFrame frame_of(const PeerScan& scan) {
  auto ranges = mrpt::obs::CObservation2DRangeScan::Create();
  const std::size_t beams = scan.ranges_m.size();
  const double width_rad = scan.angle_increment_rad * static_cast<double>(beams - 1);
  ranges->aperture = static_cast<float>(std::abs(width_rad));
  ranges->rightToLeft = scan.angle_increment_rad > 0.0;
  ranges->maxRange = static_cast<float>(scan.range_max_m);
  // MRPT's beams lie about the middle.
  const Pose2& laser = scan.robot_from_laser;
  ranges->sensorPose = mrpt::poses::CPose3D(
      laser.x, laser.y, 0.0, laser.theta + scan.angle_min_rad + width_rad / 2.0, 0.0, 0.0);
  ranges->resizeScan(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const bool is_hit = !std::isnan(scan.ranges_m[i]);
    ranges->setScanRange(i, is_hit ? static_cast<float>(scan.ranges_m[i]) : ranges->maxRange);
    ranges->setScanRangeValidity(i, is_hit);
  }
  mrpt::obs::CSensoryFrame frame;
  frame.insert(ranges);
  return frame;
}

mrpt::obs::CActionCollection motion_of(const PeerScan& before, const PeerScan& now) {
  const Pose2 motion = between(before.odom_from_robot, now.odom_from_robot);
  mrpt::obs::CActionRobotMovement2D action;
  action.computeFromOdometry({motion.x, motion.y, motion.theta}, {});
  mrpt::obs::CActionCollection actions;
  actions.insert(action);
  return actions;
}

void judge(const CMonteCarloLocalization2D& filter, const PeerScan& scan, PeerResult& result) {
  mrpt::poses::CPose2D mean;
  filter.getMean(mean);
  result.estimates.push_back({mean.x(), mean.y(), mean.phi()});
  result.errors_m.emplace_back();
  result.errors_rad.emplace_back();
  if (!scan.truth) return;
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& particle : filter.m_particles) most = std::max(most, particle.log_w);
  double sum = 0.0;
  double distance = 0.0;
  double turn = 0.0;
  for (const auto& particle : filter.m_particles) {
    const double weight = std::exp(particle.log_w - most);
    sum += weight;
    distance += weight * std::hypot(particle.d.x - scan.truth->x, particle.d.y - scan.truth->y);
    turn += weight * std::abs(angle_difference(particle.d.phi, scan.truth->theta));
  }
  result.errors_m.back() = distance / sum;
  result.errors_rad.back() = turn / sum;
}

PeerResult localize(const PeerJob& job) {
  CMonteCarloLocalization2D filter(job.particles);
  filter.options.metricMap = make_map(job.map);
  draw_start(job, filter);
  mrpt::bayes::CParticleFilter engine;
  engine.setMinLoggingLevel(mrpt::system::LVL_ERROR);
  engine.m_options.sampleSize = static_cast<unsigned>(job.particles);
  PeerResult result;
  for (std::size_t i = 0; i < job.scans.size(); ++i) {
    const mrpt::obs::CSensoryFrame frame = frame_of(job.scans[i]);
    const mrpt::obs::CActionCollection actions =
        motion_of(job.scans[i == 0 ? 0 : i - 1], job.scans[i]);
    const auto begin = std::chrono::steady_clock::now();
    engine.executeOn(filter, &actions, &frame);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    result.update_ms.push_back(took.count());
    judge(filter, job.scans[i], result);
  }
  return result;
}

}  // namespace
}  // namespace strata::peers

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: strata-peer-mrpt JOB.json RESULT.json\n";
    return 2;
  }
  try {
    std::ifstream in(argv[1]);
    const auto job = strata::peers::job_from_json(nlohmann::json::parse(in));
    std::ofstream out(argv[2]);
    out << strata::peers::to_json(strata::peers::localize(job));
    return out.flush() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "strata-peer-mrpt: error: " << error.what() << '\n';
    return 1;
  }
}
