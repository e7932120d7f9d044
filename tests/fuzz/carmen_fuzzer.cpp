// SPDX-License-Identifier: Apache-2.0
/// CARMEN logs, plain and gzipped.
#include "components/log/carmen.hpp"
#include "tests/fuzz/check_log.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const strata::fuzz::ScratchFolder scratch;
  return strata::fuzz::expect_value_or_error([&] {
    strata::log::ReadReport report;
    const auto file = scratch.write("log", {data, size});
    strata::fuzz::check_log(strata::log::read_carmen(file, {}, report));
  });
}
