// SPDX-License-Identifier: Apache-2.0
/// Map stores (strata.db).
#include <string>
#include <vector>

#include "memory/store/store.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

/// As a robot does with what it remembers.
void go_on(strata::memory::TimescaleMemory&& memory) {
  strata::PosedScan scan;
  scan.scan.angle_min_rad = -1.0F;
  scan.scan.angle_increment_rad = 0.1F;
  scan.scan.range_max_m = 10.0F;
  scan.scan.ranges_m.assign(20, 2.0F);
  for (int step = 0; step < 3; ++step) {
    scan.scan.stamp = strata::Stamp::from_seconds(2e9 + 10.0 * step);
    scan.map_from_robot.theta = 0.5 * step;
    (void)memory.observe(scan);
  }
  (void)memory.decode();
  (void)memory.state();
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  static const fuzz::ScratchFolder scratch;
  const auto file = scratch.write("strata.db", {data, size});
  // Each part by itself: damage in one must not hide the others.
  const auto read = [&](auto&& part) {
    return fuzz::expect_value_or_error(
        [&] { part(memory::Store(file, {.read_only = true, .check = false})); });
  };
  read([](const memory::Store& store) {
    for (const std::string& key : store.text_keys()) (void)store.find_text(key);
  });
  read([](const memory::Store& store) {
    for (const std::string& name : store.grid_names()) (void)store.load_reflection_grid(name);
  });
  read([](const memory::Store& store) {
    const patch::PatchMap map = store.load_patch_map();
    (void)patch::compose(map, std::vector<int>(map.submaps.size(), 0));
  });
  read([](const memory::Store& store) { go_on(store.load_timescale()); });
  read([](const memory::Store& store) {
    for (const int run : store.runs()) (void)store.load_trajectory(run);
  });
  return read([](const memory::Store& store) {
    for (const int run : store.runs_with_scans()) (void)store.load_scans(run);
  });
}
