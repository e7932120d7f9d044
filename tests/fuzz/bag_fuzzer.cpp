// SPDX-License-Identifier: Apache-2.0
/// Bag files: SQLite, MCAP and packed ones, told by content, and the messages inside.
#include "tests/fuzz/check_log.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const strata::fuzz::ScratchFolder scratch;
  return strata::fuzz::expect_value_or_error([&] {
    strata::fuzz::check_log(strata::log::read_log(scratch.write("bag", {data, size})));
  });
}
