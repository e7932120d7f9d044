// SPDX-License-Identifier: Apache-2.0
#include "components/topologies/topology_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace strata::topologies {
namespace {

using testing::HasSubstr;

/// Three landmarks, the first visited twice.
topology::Hypothesis triangle() {
  topology::Hypothesis hypothesis;
  hypothesis.labels = {0, 1, 2, 0, 1};
  hypothesis.probability = 0.75;
  hypothesis.poses = {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0.1, 0, 0}, {4.1, 0, 0}};
  return hypothesis;
}

TEST(TopologyFiles, TellLandmarksWaysAndHowOftenTheyWereDriven) {
  const nlohmann::json json = topology_json(triangle(), {});
  ASSERT_EQ(json["landmarks"].size(), 3U);
  EXPECT_EQ(json["landmarks"][0]["visits"], (std::vector<int>{0, 3}));
  EXPECT_EQ(json["landmarks"][2]["y"], 3.0);
  ASSERT_EQ(json["edges"].size(), 3U);
  EXPECT_EQ(json["edges"][0], (nlohmann::json{{"from", 0}, {"to", 1}, {"traversals", 2}}));
  EXPECT_THAT(places_yaml(triangle()), HasSubstr("places: [0, 0, 4, 0, 4, 3]"));
  std::vector<Pose2Gaussian> locations(5);
  locations[1].covariance(0, 0) = 0.25;
  const std::string graphml = topology_graphml(triangle(), locations);
  EXPECT_THAT(graphml, HasSubstr("<node id=\"n2\">"));
  EXPECT_THAT(graphml, HasSubstr("<data key=\"var_x\">0.25</data>"));
  EXPECT_THAT(graphml, HasSubstr("<edge source=\"n0\" target=\"n1\"><data key=\"traversals\">2<"));
  EXPECT_THAT(graphml, HasSubstr("<data key=\"probability\">0.75</data>"));
  EXPECT_FALSE(json["landmarks"][0].contains("name"));
  EXPECT_EQ(topology_json(triangle(), {}, {1, 4, 2})["landmarks"][1]["name"], "place 4");
  EXPECT_THAT(topology_graphml(triangle(), {}, {1, 4, 2}),
              HasSubstr("<node id=\"n2\"><data key=\"name\">place 2</data>"));
}

}  // namespace
}  // namespace strata::topologies
