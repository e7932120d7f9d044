// SPDX-License-Identifier: Apache-2.0
#include <components/settings/config_reader.hpp>
#include <core/grid/likelihood_field.hpp>

int main() {
  const auto config = strata::settings::read_config<strata::LikelihoodFieldConfig>(
      YAML::Load("{hit_weight: 0.5}"), "consumer");
  return config.hit_weight == 0.5 ? 0 : 1;
}
