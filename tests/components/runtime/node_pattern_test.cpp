// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/node_pattern.hpp"

#include <string>

#include <gtest/gtest.h>

namespace strata::runtime {
namespace {

bool matches(const std::string& pattern, const std::string& name) {
  return NodePattern(pattern).match(name).has_value();
}

TEST(NodePattern, MatchesAsRos2Does) {
  EXPECT_TRUE(matches("/a/matcher", "/a/matcher"));
  EXPECT_TRUE(matches("a/matcher", "/a/matcher"));
  EXPECT_FALSE(matches("/matcher", "/a/matcher"));
  EXPECT_TRUE(matches("/*/matcher", "/a/matcher"));
  EXPECT_FALSE(matches("/*/matcher", "/matcher"));
  EXPECT_FALSE(matches("/*/matcher", "/a/b/matcher"));
  for (const char* name : {"/matcher", "/a/matcher", "/a/b/matcher"}) {
    EXPECT_TRUE(matches("/**/matcher", name)) << name;
    EXPECT_TRUE(matches("/**", name)) << name;
    EXPECT_TRUE(matches("**", name)) << name;
    EXPECT_TRUE(matches("matcher", name)) << name << ": without a namespace it is for all";
    EXPECT_FALSE(matches("/**/mapper", name)) << name;
  }
  EXPECT_TRUE(matches("/a/**", "/a/b/matcher"));
  EXPECT_TRUE(matches("/a/**/matcher", "/a/matcher"));
  EXPECT_TRUE(matches("/**/b/*", "/a/b/matcher"));
  EXPECT_FALSE(matches("/**/b/*", "/b/a/matcher"));
  EXPECT_FALSE(matches("/*", "/a/matcher"));
  EXPECT_FALSE(matches("", "/matcher"));
}

TEST(NodePattern, RanksBySegmentsThatAreNames) {
  const char* const order[] = {"/**",         "/*/*",       "/a/**",     "/a/*",
                               "/**/matcher", "/*/matcher", "/a/matcher"};
  for (std::size_t i = 1; i < std::size(order); ++i) {
    EXPECT_LT(NodePattern(order[i - 1]).match("/a/matcher"),
              NodePattern(order[i]).match("/a/matcher"))
        << order[i];
  }
  EXPECT_EQ(NodePattern("matcher").match("/a/matcher"),
            NodePattern("/**/matcher").match("/a/matcher"));
  EXPECT_EQ(NodePattern("matcher").match("/matcher"), NodePattern("/matcher").match("/matcher"));
}

TEST(NodePattern, IsATypoOnlyOfANameNearby) {
  EXPECT_TRUE(NodePattern("localiser").is_typo_of("/localizer"));
  EXPECT_TRUE(NodePattern("lcoalizer").is_typo_of("/a/localizer"));
  EXPECT_TRUE(NodePattern("/*/localize").is_typo_of("/a/localizer"));
  EXPECT_TRUE(NodePattern("time_scale_memry").is_typo_of("/timescale_memory"));
  EXPECT_FALSE(NodePattern("map_server").is_typo_of("/map_saver")) << "both are nodes of nav2";
  EXPECT_FALSE(NodePattern("amcl").is_typo_of("/localizer"));
  EXPECT_FALSE(NodePattern("/robot2/localizer").is_typo_of("/robot1/localizer"));
  EXPECT_FALSE(NodePattern("/other/localizer").is_typo_of("/robot1/localizer"));
  EXPECT_FALSE(NodePattern("/other/localiser").is_typo_of("/robot1/localizer"));
  EXPECT_FALSE(NodePattern("/robto1/*").is_typo_of("/robot1/localizer"));
}

}  // namespace
}  // namespace strata::runtime
