// SPDX-License-Identifier: Apache-2.0
/// Trajectories: TUM, `t x y theta`, corrected CARMEN logs, and poses in bags.
#include "components/log/trajectory_file.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  static const fuzz::ScratchFolder scratch;
  return fuzz::expect_value_or_error([&] {
    (void)log::read_trajectory(scratch.write("poses", {data, size}));
  });
}
