// SPDX-License-Identifier: Apache-2.0
#include "components/log/text.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace strata::log {
namespace {

TEST(Text, StampsKeepTheirNanoseconds) {
  EXPECT_EQ(parse_stamp("1663967375.543607123")->ns, 1663967375543607123);
  EXPECT_EQ(parse_stamp("0.025466")->ns, 25466000);
  EXPECT_EQ(parse_stamp("-1.5")->ns, -1500000000);
  EXPECT_EQ(parse_stamp("12")->ns, 12000000000);
  EXPECT_EQ(parse_stamp("1.5e1")->ns, 15000000000);
  EXPECT_EQ(parse_stamp("0.0000000005")->ns, 1);
  for (const char* bad : {"", "abc", "1.2.3", "1.2x", "99999999999", "nan", "inf"}) {
    EXPECT_FALSE(parse_stamp(bad).has_value()) << bad;
  }
}

TEST(Text, StampsReadBackAsTheyWereWritten) {
  for (const std::int64_t ns : {0LL, 1LL, -1LL, 25466000LL, 1663967375543607123LL, -1500000000LL}) {
    EXPECT_EQ(parse_stamp(format_stamp({ns}))->ns, ns) << format_stamp({ns});
  }
}

TEST(Text, NumbersReadBackToTheSameBits) {
  for (const float value : {0.1F, 81.83F, 1e-30F, 3.4e38F, -0.0F}) {
    EXPECT_EQ(*parse_float(format_number(value)), value);
  }
  EXPECT_TRUE(std::isnan(*parse_float(format_number(std::nanf("")))));
  EXPECT_TRUE(std::isinf(*parse_float(format_number(std::numeric_limits<float>::infinity()))));
  EXPECT_FALSE(parse_double("1.5m").has_value());
  EXPECT_FALSE(parse_double("").has_value());
}

}  // namespace
}  // namespace strata::log
