// SPDX-License-Identifier: Apache-2.0
/// Bag files: SQLite, MCAP, packed ones and those of ROS 1, told by content, the scans inside, and
/// the QoS that a player takes from them.
#include "components/player/source.hpp"
#include "tests/fuzz/check_log.hpp"
#include "tests/fuzz/fuzz_target.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const strata::fuzz::ScratchFolder scratch;
  const auto file = scratch.write("bag", {data, size});
  strata::fuzz::expect_value_or_error([&] {
    const auto reader = strata::log::BagReader::open(file);
    for (const auto& topic : reader->topics()) (void)strata::player::recorded_qos(topic);
  });
  return strata::fuzz::expect_value_or_error(
      [&] { strata::fuzz::check_log(strata::log::read_log(file)); });
}
