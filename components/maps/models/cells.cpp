// SPDX-License-Identifier: Apache-2.0
/// `cells`: every cell has a chain of its own, learned from the scans that the maps were made of.
#include <memory>
#include <string>
#include <utility>

#include "components/maps/models/ranges.hpp"
#include "core/base/parallel.hpp"
#include "core/cells/cell_learner.hpp"
#include "core/cells/cell_model.hpp"

namespace strata::maps {
namespace {

MapModel make_cells(const Maps& maps, const std::string& /*argument*/,
                    const patch_beams::PatchBeamModelConfig& config) {
  cells::CellLearner learner(maps.occupancy.resolution_m());
  maps.visit_scans([&](const PosedScan& scan) { learner.add(scan); });
  WorkerPool pool(1);
  const auto map = std::make_shared<const cells::CellMap>(learner.finish(pool));
  const auto sensor = std::make_shared<const cells::CellModel>(map, config.beam);
  MapModel model;
  model.sensor = sensor;
  model.best_prediction = [ranges = ranges_of<cells::ShownRanges>(sensor->ranges())](
                              const localization::ParticleSet&) { return ranges; };
  model.bytes = sensor->bytes();
  model.resident_bytes = sensor->resident_bytes();
  return model;
}

}  // namespace

void add_cells(MapModels& models) {
  MapModelDescriptor model;
  model.name = "cells";
  model.family = "cells";
  model.description = "each cell a chain of two states, which fades to what is usual there";
  model.needs = {MapPart::kScans};
  model.learns = MapLearning::kCells;
  model.make = make_cells;
  models.add(std::move(model));
}

}  // namespace strata::maps
