// SPDX-License-Identifier: Apache-2.0
/// metadata.yaml of a bag folder, beside a file that it may name.
#include "components/log/bag_storage.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const strata::fuzz::ScratchFolder scratch;
  return strata::fuzz::expect_value_or_error([&] {
    scratch.write("bag_0.mcap", {});
    scratch.write("metadata.yaml", {data, size});
    if (strata::log::bag_files(scratch.path()).files.empty()) __builtin_trap();
  });
}
