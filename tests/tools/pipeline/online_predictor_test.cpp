// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/online_predictor.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/pipeline/changed_room.hpp"

namespace strata::pipeline {
namespace {

TEST(MemoryWatcher, ExpectsWhatTheChosenDecoderDecodes) {
  maps::Maps maps;
  maps.timescale = std::make_shared<memory::TimescaleMemory>(test::changed_room());
  maps.filtered = ReflectionGrid(0.05, {{-10, -10}, {10, 10}}, 0.0F);
  std::vector<std::vector<double>> expected;
  for (const memory::DecodingConfig& decoding :
       {memory::scene_decoding(), memory::exact_decoding(), memory::literal_decoding()}) {
    maps.decoding = decoding;
    maps.nodes = nullptr;
    maps::MapModel model;
    model.name = "timescale";
    model.descriptor = maps::map_models().at(model.name);
    const auto watcher = make_online_predictor(maps, model, {});
    maps::Maps decoded = maps;
    decoded.nodes = maps.timescale->decode(decoding);
    const auto reference = maps::make_map_model(decoded, "timescale", {}).best_prediction({});
    const auto range = watcher->expected_range();
    expected.emplace_back();
    for (double bearing_rad = -3.1; bearing_rad < 3.1; bearing_rad += 0.05) {
      const Pose2 laser{0.5, 0.3, 0.2};
      expected.back().push_back(range(laser, bearing_rad));
      EXPECT_EQ(expected.back().back(), reference(laser, bearing_rad)) << bearing_rad;
    }
  }
  // The room tells these decoders apart, so that the comparison above means something.
  EXPECT_NE(expected[0], expected[1]);
  EXPECT_NE(expected[1], expected[2]);
}

}  // namespace
}  // namespace strata::pipeline
