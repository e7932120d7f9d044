// SPDX-License-Identifier: Apache-2.0
#include <strata/grid/likelihood_field.hpp>
#include <strata/settings/config_reader.hpp>

int main() {
  const auto config = strata::settings::read_config<strata::LikelihoodFieldConfig>(
      YAML::Load("{hit_weight: 0.5}"), "consumer");
  return config.hit_weight == 0.5 ? 0 : 1;
}
