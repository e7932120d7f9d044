// SPDX-License-Identifier: Apache-2.0
#include "core/topology/particle.hpp"

#include <algorithm>
#include <numeric>

namespace strata::topology {

std::vector<std::size_t> by_weight(const std::vector<Particle>& particles,
                                   const std::vector<double>& log_weights) {
  std::vector<std::size_t> order(particles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (log_weights[a] != log_weights[b]) return log_weights[a] > log_weights[b];
    return particles[a].hypothesis.labels < particles[b].hypothesis.labels;
  });
  return order;
}

}  // namespace strata::topology
