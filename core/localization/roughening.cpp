// SPDX-License-Identifier: Apache-2.0
#include "core/localization/roughening.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include "core/random/stream.hpp"

namespace strata::localization {

double pose_spacing(double area_m2, std::size_t count) {
  return std::cbrt(area_m2 * 2.0 * std::numbers::pi / static_cast<double>(count));
}

void roughen(double stddev, std::uint64_t seed, std::uint64_t step, ParticleSet& particles,
             WorkerPool& pool) {
  constexpr std::size_t kChunk = 256;
  const auto move = [&](std::size_t begin, std::size_t end, std::size_t /*chunk*/) {
    for (std::size_t i = begin; i < end; ++i) {
      RandomStream random(seed, StreamId::kRoughening, step, static_cast<std::uint32_t>(i));
      Pose2 pose = particles.pose(i);
      pose.x += stddev * random.normal();
      pose.y += stddev * random.normal();
      pose.theta += stddev * random.normal();
      particles.set_pose(i, pose);
    }
  };
  pool.for_chunks(particles.size(), kChunk, std::cref(move));
}

}  // namespace strata::localization
