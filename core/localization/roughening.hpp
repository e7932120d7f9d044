// SPDX-License-Identifier: Apache-2.0
/// Spreading particles that were copied from a few, while the place is still looked for.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/parallel.hpp"
#include "core/localization/particle_set.hpp"

namespace strata::localization {

/// The side of the cube that each of `count` poses has to itself when they are spread over an area
/// and all headings; a radian counts as a metre [m, rad]. The interval over the root of the number
/// in [gordon1993novel], with the whole free space for the interval. Requires count > 0.
[[nodiscard]] double pose_spacing(double area_m2, std::size_t count);

/// x_i <- x_i + N(0, stddev) in x, y [m] and heading [rad], independently: roughening
/// [gordon1993novel]. A place that only a few particles of a coarse start are near is not lost
/// because none of them was near enough. Particle i draws from (seed, kRoughening, step, i). O(N).
void roughen(double stddev, std::uint64_t seed, std::uint64_t step, ParticleSet& particles,
             WorkerPool& pool);

}  // namespace strata::localization
