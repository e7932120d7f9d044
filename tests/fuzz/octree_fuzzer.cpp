// SPDX-License-Identifier: Apache-2.0
/// OctoMap's .ot and .bt files. What is read can be written, and is then read as the same tree.
#include "core/volume/volume_map.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  return fuzz::expect_value_or_error([&] {
    const auto map = volume::VolumeMap::from_file(fuzz::text_of({data, size}), "fuzzed");
    const auto again = volume::VolumeMap::from_file(map.full_file(), "written");
    if (again.full_file() != map.full_file()) __builtin_trap();
  });
}
