// SPDX-License-Identifier: Apache-2.0
/// Map stores (strata.db).
#include "memory/store/store.hpp"
#include "tests/fuzz/fuzz_target.hpp"

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
  read([](const memory::Store& store) { (void)store.load_patch_map(); });
  read([](const memory::Store& store) { (void)store.load_timescale(); });
  read([](const memory::Store& store) {
    for (const int run : store.runs()) (void)store.load_trajectory(run);
  });
  return read([](const memory::Store& store) {
    for (const int run : store.runs_with_scans()) (void)store.load_scans(run);
  });
}
