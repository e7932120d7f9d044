// SPDX-License-Identifier: Apache-2.0
/// A message is not to blame when memory runs out while it is read. A program of its own, since it
/// replaces the global allocation functions.
#include <cstddef>
#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/scan_messages.hpp"
#include "tests/support/counted_allocations.hpp"

namespace strata::convert {
namespace {

TEST(MemoryRunsOut, AndNoMessageIsBlamed) {
  sensor_msgs::msg::LaserScan scan;
  scan.header().frame_id(std::string(100, 'l'));
  scan.ranges(std::vector<float>(1000, 1.0F));
  const std::vector<std::uint8_t> bytes = to_cdr(scan);
  // What is made once, for all messages of the type, is there then.
  ASSERT_EQ(from_cdr<sensor_msgs::msg::LaserScan>(bytes, "/scan").ranges().size(), 1000U);
  std::size_t failures = 0;
  for (std::size_t number = 1;; ++number) {
    test::failing_allocation = test::allocations + number;
    try {
      const auto read = from_cdr<sensor_msgs::msg::LaserScan>(bytes, "/scan");
      test::failing_allocation = 0;
      EXPECT_EQ(read.ranges().size(), 1000U);
      break;
    } catch (const std::bad_alloc&) {
      ++failures;
    } catch (const std::exception& error) {
      test::failing_allocation = 0;
      FAIL() << error.what();
    }
  }
  EXPECT_GE(failures, 2U) << "the frame's name and the ranges";
}

}  // namespace
}  // namespace strata::convert
