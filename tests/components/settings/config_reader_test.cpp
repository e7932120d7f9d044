// SPDX-License-Identifier: Apache-2.0
#include "components/settings/config_reader.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/components/settings/sample_config.hpp"

namespace strata::settings {
namespace {

using test::CartConfig;
using test::Color;
using testing::HasSubstr;

CartConfig read(const std::string& text) {
  return read_config<CartConfig>(parse_yaml(text, "cart.yaml"), "cart.yaml");
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReadConfig, FillsEveryKindOfField) {
  const CartConfig cart = read(R"(
enabled: false
seats: 7
offset: -12
seed: 18446744073709551615
length_m: 1e-3
name: "two words"
gains: [0.1, 1]
sizes: [3, -4]
tags: [x, "y z"]
spare: {radius_m: 0.2, color: green}
wheels:
  - radius_m: 0.3
  - color: green
)");
  EXPECT_FALSE(cart.enabled);
  EXPECT_EQ(cart.seats, 7);
  EXPECT_EQ(cart.offset, -12);
  EXPECT_EQ(cart.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(cart.length_m, 1e-3);
  EXPECT_EQ(cart.name, "two words");
  EXPECT_THAT(cart.gains, testing::ElementsAre(0.1, 1.0));
  EXPECT_THAT(cart.sizes, testing::ElementsAre(3, -4));
  EXPECT_THAT(cart.tags, testing::ElementsAre("x", "y z"));
  EXPECT_EQ(cart.spare.radius_m, 0.2);
  EXPECT_EQ(cart.spare.color, Color::kGreen);
  ASSERT_EQ(cart.wheels.size(), 2U);
  EXPECT_EQ(cart.wheels[0].radius_m, 0.3);
  EXPECT_EQ(cart.wheels[0].color, Color::kRed);
  EXPECT_EQ(cart.wheels[1].color, Color::kGreen);
}

TEST(ReadConfig, LeavesDefaultsWhereKeysAreMissing) {
  EXPECT_EQ(read(""), CartConfig{});
  EXPECT_EQ(read("spare:\n"), CartConfig{});
}

TEST(ReadConfig, StartsFromTheGivenStruct) {
  CartConfig start;
  start.seats = 9;
  const auto cart = read_config<CartConfig>(parse_yaml("name: b", "x"), "x", start);
  EXPECT_EQ(cart.seats, 9);
  EXPECT_EQ(cart.name, "b");
}

TEST(ReadConfig, NamesFileLineAndNearestKeyForAnUnknownKey) {
  EXPECT_EQ(error_of("seats: 2\nspare:\n  raduis_m: 0.1\n"),
            "cart.yaml:3: spare.raduis_m is an unknown key; did you mean 'radius_m'?");
  EXPECT_THAT(error_of("zzzzzzzzzz: 2"), HasSubstr("known keys are: enabled, seats"));
}

TEST(ReadConfig, RefusesAKeyGivenTwice) {
  EXPECT_THAT(error_of("seats: 2\nseats: 3"), HasSubstr("cart.yaml:2: seats is given twice"));
}

TEST(ReadConfig, RefusesWrongTypesWithTheLine) {
  EXPECT_EQ(error_of("\nlength_m: long"),
            "cart.yaml:2: length_m is 'long', not a number; write a number");
  EXPECT_THAT(error_of("seats: 2.5"), HasSubstr("seats is '2.5', not a whole number"));
  EXPECT_THAT(error_of("seats: 9999999999"), HasSubstr("not a whole number from"));
  EXPECT_THAT(error_of("seed: -1"), HasSubstr("not a whole number from 0"));
  EXPECT_THAT(error_of("enabled: maybe"), HasSubstr("not true or false"));
  EXPECT_THAT(error_of("gains: 0.5"), HasSubstr("gains is '0.5', not a list"));
  EXPECT_THAT(error_of("gains: [0.5, x]"), HasSubstr("gains[1] is 'x', not a number"));
  EXPECT_THAT(error_of("spare: 3"), HasSubstr("spare is '3', not a group of keys"));
  EXPECT_THAT(error_of("wheels: {a: 1}"), HasSubstr("wheels is a group of keys, not a list"));
  EXPECT_THAT(error_of("name: [a]"), HasSubstr("name is a list, not text"));
  EXPECT_THAT(error_of("length_m:"), HasSubstr("length_m has no value, not a number"));
  EXPECT_THAT(error_of("length_m: nan"), HasSubstr("not a number"));
  EXPECT_THAT(error_of("length_m: 0x10"), HasSubstr("not a number"));
}

TEST(ReadConfig, SuggestsAChoiceOfAnEnum) {
  EXPECT_EQ(error_of("spare: {color: gren}"),
            "cart.yaml:1: spare.color is 'gren', which is no choice; did you mean 'green'?");
}

TEST(ReadConfig, ListsEveryProblemOfValidationWithItsLine) {
  const std::string error = error_of("length_m: -1\ngains: [0.5, 2]\nwheels:\n  - radius_m: 0\n");
  EXPECT_THAT(error, HasSubstr("cart.yaml:1: length_m is -1, below the least value 0"));
  EXPECT_THAT(error, HasSubstr("at cart.yaml:2 gains[1] is 2, above"));
  EXPECT_THAT(error, HasSubstr("at cart.yaml:4 wheels[0].radius_m is 0, below"));
  EXPECT_THAT(error_of("seats: 100"), HasSubstr("seats are more than a cart has; order a bus"));
}

TEST(ReadConfig, PointsAtTheOptionWhenTheValueCameFromSet) {
  YAML::Node node = parse_yaml("seats: 2", "cart.yaml");
  apply_override(node, "spare.radius_m=wide");
  try {
    (void)read_config<CartConfig>(node, "cart.yaml");
    FAIL() << "no error";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.place(), "--set spare.radius_m");
  }
}

TEST(ReadConfig, DoesNotChangeTheDocument) {
  const YAML::Node node = parse_yaml("seats: 2", "cart.yaml");
  (void)read_config<CartConfig>(node, "cart.yaml");
  EXPECT_EQ(node.size(), 1U);
}

}  // namespace
}  // namespace strata::settings
