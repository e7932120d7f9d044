// SPDX-License-Identifier: Apache-2.0
#include "components/settings/old_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"

namespace strata::settings {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct RenamedWheelConfig {
  double min_m = 0.1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("min_m", c.min_m, {.doc = "radius", .min = 0.01});
    v.renamed("least_m", "min_m");
  }
};

struct RenamedCartConfig {
  int max_seats = 4;
  RenamedWheelConfig spare;
  std::vector<RenamedWheelConfig> wheels;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("max_seats", c.max_seats, {.doc = "places"});
    v.group("spare", c.spare, "the wheel on the back");
    v.list("wheels", c.wheels, "on the road");
    v.renamed("most_seats", "max_seats");
    v.renamed("rear", "spare");
    v.renamed("rollers", "wheels");
    v.removed("horn", "carts have none");
  }
};

struct Read {
  RenamedCartConfig cart;
  Notes notes;
};

Read read_old(const std::string& text, const std::vector<std::string>& overrides = {}) {
  Read result;
  YAML::Node document = parse_yaml(text, "cart.yaml");
  apply_overrides(document, overrides);
  result.cart = read_config<RenamedCartConfig>(document, "cart.yaml", {}, &result.notes);
  return result;
}

std::string error_of_old(const std::string& text) {
  try {
    (void)read_old(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OldKeys, OfFieldsAreReadWithANoteThatNamesTheLineAndTheNewKey) {
  const Read result = read_old("most_seats: 7\n");
  EXPECT_EQ(result.cart.max_seats, 7);
  EXPECT_THAT(result.notes,
              ElementsAre("cart.yaml:1: most_seats is called max_seats now; the next version will "
                          "not know the old name"));
}

TEST(OldKeys, OfGroupsAndListsAreReadWithWhatIsInThem) {
  const Read result =
      read_old("rear: {least_m: 0.2}\nrollers:\n  - least_m: 0.3\n  - min_m: 0.4\n");
  EXPECT_EQ(result.cart.spare.min_m, 0.2);
  ASSERT_EQ(result.cart.wheels.size(), 2U);
  EXPECT_EQ(result.cart.wheels[0].min_m, 0.3);
  EXPECT_EQ(result.cart.wheels[1].min_m, 0.4);
  EXPECT_THAT(result.notes,
              ElementsAre(HasSubstr("cart.yaml:1: rear is called spare now"),
                          HasSubstr("cart.yaml:1: spare.least_m is called spare.min_m now"),
                          HasSubstr("cart.yaml:2: rollers is called wheels now"),
                          HasSubstr("cart.yaml:3: wheels[0].least_m")));
}

TEST(OldKeys, ThatAreGoneAreLeftOutWithTheReason) {
  const Read result = read_old("horn: loud\nmax_seats: 2\n");
  EXPECT_EQ(result.cart.max_seats, 2);
  EXPECT_THAT(result.notes,
              ElementsAre("cart.yaml:1: horn is gone and is left out: carts have none"));
}

TEST(OldKeys, BesideTheNewOneAreRefusedInAFileAndWinBehindSet) {
  EXPECT_THAT(error_of_old("max_seats: 5\nmost_seats: 7\n"),
              HasSubstr("cart.yaml:2: most_seats is given, and max_seats"));
  EXPECT_EQ(read_old("max_seats: 5\n", {"most_seats=7"}).cart.max_seats, 7);
  EXPECT_EQ(read_old("most_seats: 5\n", {"max_seats=7"}).cart.max_seats, 7);
}

TEST(OldKeys, KeepTheLineForWhatIsWrongWithTheirValues) {
  EXPECT_THAT(error_of_old("max_seats: 1\nrear:\n  least_m: 0\n"), HasSubstr("cart.yaml:3"));
  EXPECT_THAT(error_of_old("max_seats: 1\nmost_saets: 2\n"), HasSubstr("cart.yaml:2"));
  EXPECT_THAT(error_of_old("horn: 1\nspare:\n  least_m: x\n"), HasSubstr("cart.yaml:3"));
}

TEST(OldKeys, LeaveADocumentWithoutThemAsItIs) {
  const YAML::Node document = parse_yaml("max_seats: 1\nspare: {min_m: 0.2}\n", "cart.yaml");
  Notes notes;
  const KeyTree tree = key_tree<RenamedCartConfig>();
  EXPECT_TRUE(with_present_keys(document, "cart.yaml", tree, notes).is(document));
  EXPECT_THAT(notes, IsEmpty());
}

TEST(OldKeys, HaveAPresentForm) {
  const KeyTree tree = key_tree<RenamedCartConfig>();
  EXPECT_EQ(present_key("most_seats", tree), "max_seats");
  EXPECT_EQ(present_key("rear.least_m", tree), "spare.min_m");
  EXPECT_EQ(present_key("spare.min_m", tree), "spare.min_m");
  EXPECT_EQ(present_key("horn", tree), "");
  EXPECT_EQ(present_key("unknown.key", tree), "unknown.key");
  EXPECT_TRUE(is_key("horn", tree));
  EXPECT_FALSE(is_key("unknown", tree));
}

}  // namespace
}  // namespace strata::settings
