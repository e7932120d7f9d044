// SPDX-License-Identifier: Apache-2.0
/// What refines the poses of a robot that is localized with a model.
#pragma once

#include <memory>

#include "components/maps/map_models.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/refinement/pose_refiner.hpp"

namespace strata::maps {

/// With the map that the model localizes in and its changeable areas; a model without a grid of its
/// own takes the filtered map. Throws ConfigError. O(cells).
[[nodiscard]] std::unique_ptr<refinement::PoseRefiner> make_refiner(
    const Maps& maps, const MapModelDescriptor& model, const refinement::RefinementConfig& config);

}  // namespace strata::maps
