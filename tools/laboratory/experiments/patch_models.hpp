// SPDX-License-Identifier: Apache-2.0
/// The map models that localization in changing worlds is compared with, and which of a patch map's
/// configurations are true.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/localization/sensor_model.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"

namespace strata::experiments {

using Model = std::shared_ptr<const localization::SensorModel>;

[[nodiscard]] Model grid_model(const ReflectionGrid& map);
/// occupancy, filtered, patch_paper (no memory), patch_shared; any other name: patch.
[[nodiscard]] Model model_named(const std::string& name, const StaticMaps& maps,
                                const std::shared_ptr<const patch::PatchMap>& patches);

/// The configuration of each sub-map that stands for what is true on the test day; nothing where
/// that state was not learned.
using TrueConfigurations = std::vector<std::optional<std::size_t>>;
[[nodiscard]] TrueConfigurations true_configurations(const simulate::Simulation& learned,
                                                     const patch::PatchMap& map,
                                                     const simulate::Simulation& tested, int day);

}  // namespace strata::experiments
