// SPDX-License-Identifier: Apache-2.0
#include "core/base/config.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace strata {
namespace {

enum class Colour { kRed, kBlue, kUnnamed };

struct Inner {
  double share = 0.5;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("share", c.share, {.doc = "a share", .unit = "1", .min = 0.0, .max = 1.0});
  }
};

struct Outer {
  int count = 3;
  std::vector<double> noise{0.1, 0.2};
  Colour colour = Colour::kBlue;
  std::string name = "x";
  Inner inner;
  std::vector<Inner> items{{}, {}};
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("count", c.count, {.min = 1.0, .max = 9.0});
    v.field("noise", c.noise, {.min = 0.0});
    v.field("colour", c.colour, {});
    v.field("name", c.name, {});
    v.group("inner", c.inner, "a group");
    v.list("items", c.items, "a list");
    v.require(c.count != 5, "count", "is 5", "choose another");
  }
};

}  // namespace
}  // namespace strata

template <>
struct strata::EnumNames<strata::Colour> {
  static constexpr std::array<std::pair<strata::Colour, const char*>, 2> values{
      {{strata::Colour::kRed, "red"}, {strata::Colour::kBlue, "blue"}}};
};

namespace strata {
namespace {

TEST(Validate, AcceptsDefaultsAndTheBordersOfARange) {
  Outer config;
  EXPECT_TRUE(validate(config).empty());
  config.count = 9;
  config.inner.share = 0.0;
  EXPECT_TRUE(validate(config).empty());
}

TEST(Validate, ListsEveryProblemWithItsPath) {
  Outer config;
  config.count = 0;
  config.noise[1] = -1.0;
  config.inner.share = 2.0;
  config.items[1].share = std::numeric_limits<double>::quiet_NaN();
  const Problems problems = validate(config, "top");
  ASSERT_EQ(problems.size(), 4U);
  EXPECT_EQ(problems[0].path, "top.count");
  EXPECT_EQ(problems[0].what, "is 0, below the least value 1");
  EXPECT_EQ(problems[1].path, "top.noise[1]");
  EXPECT_EQ(problems[2].path, "top.inner.share");
  EXPECT_EQ(problems[2].remedy, "choose a value of at most 1");
  EXPECT_EQ(problems[3].path, "top.items[1].share");
  EXPECT_EQ(problems[3].what, "is not a number");
}

TEST(Validate, ChecksRequirementsAcrossFields) {
  Outer config;
  config.count = 5;
  const Problems problems = validate(config);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].path, "count");
}

TEST(RequireValid, ThrowsOneErrorThatNamesAllProblems) {
  Outer config;
  config.count = 0;
  config.inner.share = 2.0;
  try {
    require_valid(config, "robot.yaml");
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.place(), "robot.yaml");
    EXPECT_NE(error.problem().find("count is 0"), std::string::npos);
    EXPECT_NE(error.problem().find("inner.share is 2"), std::string::npos);
  }
  EXPECT_NO_THROW(require_valid(Outer{}, "robot.yaml"));
}

TEST(EnumName, NamesValuesAndMarksThoseWithoutAName) {
  EXPECT_STREQ(enum_name(Colour::kRed), "red");
  EXPECT_STREQ(enum_name(Colour::kUnnamed), "?");
}

struct PriorConfig {
  double prior = 0.9;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("prior", c.prior, {.doc = "above one half", .min = 0.5, .max = 1.0});
    v.require(c.prior > 0.5, "prior", "is 0.5, where nothing is learned", "choose 0.9");
  }
};

TEST(Config, TellsOneProblemOfAKey) {
  try {
    require_valid(PriorConfig{0.2}, "--set");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "--set: prior is 0.2, below the least value 0.5; choose a value of at least 0.5");
  }
  try {
    require_valid(PriorConfig{0.5}, "--set");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "--set: prior is 0.5, where nothing is learned; choose 0.9");
  }
}

}  // namespace
}  // namespace strata
