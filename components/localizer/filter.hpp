// SPDX-License-Identifier: Apache-2.0
/// The filter that a localizer's settings and maps make: live, and when its run is gone through
/// again.
#pragma once

#include <cstdint>
#include <memory>

#include "components/localizer/config.hpp"
#include "components/maps/map_model.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/localization/localizer.hpp"

namespace strata::localizer {

/// The maps of the folder, to be used as the settings say. Throws InputError.
[[nodiscard]] maps::Maps read_maps(const LocalizerComponentConfig& config,
                                   const std::filesystem::path& folder);

/// What is known before anything came over topics.
[[nodiscard]] maps::Maps no_maps(const LocalizerComponentConfig& config);

/// Throws as maps::make_map_model.
[[nodiscard]] maps::MapModel make_model(const LocalizerComponentConfig& config,
                                        const maps::Maps& maps);

/// Not started. Throws ConfigError.
[[nodiscard]] std::unique_ptr<localization::Localizer> make_filter(
    const LocalizerComponentConfig& config, const maps::MapModel& model, const maps::Maps& maps,
    std::uint64_t seed, int threads);

}  // namespace strata::localizer
