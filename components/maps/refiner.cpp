// SPDX-License-Identifier: Apache-2.0
#include "components/maps/refiner.hpp"

namespace strata::maps {

std::unique_ptr<refinement::PoseRefiner> make_refiner(const Maps& maps,
                                                      const MapModelDescriptor& model,
                                                      const refinement::RefinementConfig& config) {
  const ReflectionGrid* own = grid_of(model, maps);
  const ReflectionGrid& grid = own != nullptr ? *own : maps.filtered;
  // Surfaces are those of our own scans, in our own frame.
  static const SurfaceLayer none;
  const SurfaceLayer& surfaces = &grid == &maps.given ? none : maps.surfaces;
  return std::make_unique<refinement::PoseRefiner>(grid, surfaces, patches_of(model, maps), config);
}

}  // namespace strata::maps
