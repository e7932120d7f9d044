// SPDX-License-Identifier: Apache-2.0
#include "components/topologies/topology_messages.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

TEST(Topologies, TravelBitForBitAndOnesThatContradictThemselvesAreRefused) {
  topology::TopologySummary summary;
  summary.probability = 1.0 / 3.0;
  summary.log_evidence = -1e3 / 7.0;
  summary.labels = {0, 1, 0};
  summary.landmarks = {{{0.1, 0.2, 0.3}, Eigen::Matrix3d::Zero()},
                       {{-1.0 / 3.0, 2.0, 0.1}, 0.01 * Eigen::Matrix3d::Identity()}};
  const std::vector<Stamp> visits{{1}, {2}, {3'000'000'007}};
  const std::vector<topology::TopologySummary> all{summary, summary};
  const auto message = to_message(all, visits, "map");
  EXPECT_EQ(from_message(message.header().stamp()), visits.back());
  const auto bytes = to_cdr(message);
  const auto back = from_message(from_cdr<strata_msgs::msg::Topologies>(bytes, "test"));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[1].labels, summary.labels);
  EXPECT_EQ(back[1].landmarks[1].covariance, summary.landmarks[1].covariance);
  EXPECT_EQ(to_cdr(to_message(back, visits, "map")), bytes);
  for (const std::vector<std::int32_t>& labels :
       {std::vector<std::int32_t>{0, 1}, {1, 0, 1}, {0, 1, 2}, {0, 0, 0}}) {
    auto wrong = message;
    wrong.topologies()[1].labels(labels);
    EXPECT_THROW((void)from_message(wrong), InputError);
  }
}

}  // namespace
}  // namespace strata::convert
