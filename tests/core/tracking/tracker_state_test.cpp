// SPDX-License-Identifier: Apache-2.0
// A tracker as bytes.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/state_archive.hpp"
#include "core/geometry/matrix_state.hpp"
#include "core/grid/grid_state.hpp"
#include "core/tracking/tracker.hpp"
#include "tests/core/registration/room_world.hpp"

namespace strata::slam {
namespace {

/// The state of a tracker that was made where every byte was `before`, after each scan.
std::vector<std::vector<std::uint8_t>> states_on(unsigned char before) {
  alignas(Tracker) std::byte place[sizeof(Tracker)];
  std::memset(place, before, sizeof place);
  auto* tracker = new (place) Tracker({}, 0.05, 0, Pose2{});
  std::vector<std::vector<std::uint8_t>> states;
  for (int n = 0; n <= 30; ++n) {
    StateWriter writer;
    Tracker::state(std::as_const(*tracker), writer);
    states.push_back(writer.take());
    const Pose2 at{2.0 + 0.05 * n, 3.0, 0.02 * n};
    (void)tracker->add(test::scan_of(test::room(), at, 0.2 * n, 0.01), &at,
                       static_cast<std::size_t>(n));
  }
  tracker->~Tracker();
  return states;
}

TEST(TrackerState, HasTheSameBytesWhereverTheTrackerWasMade) {
  const auto here = states_on(0x00);
  const auto there = states_on(0xa5);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t n = 0; n < here.size(); ++n) EXPECT_TRUE(here[n] == there[n]) << "scan " << n;
}

}  // namespace
}  // namespace strata::slam
