// SPDX-License-Identifier: Apache-2.0
#include "core/grid/likelihood_field.hpp"

#include <cmath>

#include "core/base/config.hpp"
#include "core/grid/distance_field.hpp"

namespace strata {
namespace {

double log_likelihood_at(double distance_m, const LikelihoodFieldConfig& config) {
  const double z = distance_m / config.hit_stddev_m;
  return std::log(config.hit_weight * std::exp(-0.5 * z * z) + (1.0 - config.hit_weight));
}

}  // namespace

LikelihoodField::LikelihoodField(const ReflectionGrid& map, const LikelihoodFieldConfig& config) {
  require_valid(config, "likelihood_field");
  const DistanceField distances = make_distance_field(map, config.max_distance_m);
  table_ = Grid<float>(map.resolution_m(), map.rect(),
                       static_cast<float>(log_likelihood_at(config.max_distance_m, config)));
  for (std::size_t i = 0; i < distances.size(); ++i) {
    table_.values()[i] =
        static_cast<float>(log_likelihood_at(static_cast<double>(distances.values()[i]), config));
  }
}

}  // namespace strata
