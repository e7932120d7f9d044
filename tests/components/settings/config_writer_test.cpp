// SPDX-License-Identifier: Apache-2.0
#include "components/settings/config_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/settings/settings.hpp"
#include "core/random/stream.hpp"
#include "tests/components/settings/sample_config.hpp"

namespace strata::settings {
namespace {

using test::CartConfig;
using test::WheelConfig;
using testing::HasSubstr;

CartConfig random_cart(RandomStream& random) {
  const std::vector<std::string> texts{"",    "a b", "~",      "true", "null", "x: y",  "[1, 2]",
                                       "a,b", "#",   "\"q\"",  "'",    "12",   "1e5",   "- a",
                                       "ö",   "\t",  "a\nb\n", "{}",   ": ",   "&anch", "*"};
  const auto text = [&] { return texts[random.below(static_cast<std::uint32_t>(texts.size()))]; };
  CartConfig cart;
  cart.enabled = random.bernoulli(0.5);
  cart.seats = static_cast<int>(random.below(100));
  cart.offset = -static_cast<std::int64_t>(random.next_u64() >> 1);
  cart.seed = random.next_u64();
  cart.length_m = std::exp(50.0 * random.normal());
  cart.name = text();
  cart.gains.assign(random.below(4), 0.0);
  for (double& gain : cart.gains) gain = random.uniform();
  cart.sizes.assign(random.below(3), static_cast<int>(random.next_u32()));
  cart.tags.clear();
  for (std::uint32_t i = random.below(4); i > 0; --i) cart.tags.push_back(text());
  cart.wheels.resize(random.below(3));
  for (WheelConfig& wheel : cart.wheels) wheel.radius_m = random.uniform(0.01, 1.0);
  return cart;
}

TEST(WriteYaml, ReadsBackToTheSameBits) {
  RandomStream random(7, StreamId::kTest);
  for (int i = 0; i < 300; ++i) {
    const CartConfig cart = random_cart(random);
    const std::string text = write_yaml(cart, {.with_comments = i % 2 == 0});
    const auto back = read_config<CartConfig>(parse_document(text, "cart.yaml"), "cart.yaml");
    ASSERT_EQ(back, cart) << text;
  }
}

TEST(WriteYaml, CommentsEachFieldWithUnitAndMeaning) {
  EXPECT_THAT(write_yaml(CartConfig{}, {.with_comments = true}),
              HasSubstr("length_m: 2.5  # [m] overall\n"));
}

TEST(ReferenceMarkdown, HasARowForEveryKeyWithDefaultUnitAndRange) {
  const std::string page = reference_markdown<CartConfig>();
  EXPECT_THAT(page, HasSubstr("| `length_m` | number | `2.5` | m | at least 0 | overall |"));
  EXPECT_THAT(page, HasSubstr("| `spare` | group |  |  |  | the wheel on the back |"));
  EXPECT_THAT(page,
              HasSubstr("| `spare.radius_m` | number | `0.1` | m | 0.01 to 1 | of the tyre |"));
  EXPECT_THAT(page, HasSubstr("| `wheels[].color` | one of `red`, `green` | `red` |  |  | "
                              "red \\| green |"));
  EXPECT_THAT(page, HasSubstr("| `gains` | list of numbers | `[0.5, 0.25]` |"));
  EXPECT_THAT(page, HasSubstr("| `offset` | whole number | `-3` |  | at most 10 |"));
}

struct TieredConfig {
  double speed_mps = 1.0;
  double gain = 2.0;
  WheelConfig wheel;
  std::vector<WheelConfig> spares;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("gain", c.gain, {.doc = "of the loop", .preset = {"paper", "3"}});
    v.field("speed_mps", c.speed_mps, {.doc = "greatest", .when = "the road is bad"});
    v.group("wheel", c.wheel, "the only one");
    v.list("spares", c.spares, "more");
  }
};

TEST(ReferenceMarkdown, HasWhatUsersSetFirstThenPresetsExpertsAndLists) {
  const std::string row = "| number | `2` |  |  | of the loop |\n";
  EXPECT_EQ(reference_markdown<TieredConfig>(),
            "## Settings\n\n"
            "| key | type | default | unit | range | meaning | touch it when |\n"
            "|---|---|---|---|---|---|---|\n"
            "| `speed_mps` | number | `1` |  |  | greatest | the road is bad |\n"
            "\n## Presets\n\n`preset: NAME` sets at once what the paper's form of the algorithm "
            "is; keys beside it win. Several: `preset: [NAME, NAME]`.\n\n"
            "| preset | sets |\n|---|---|\n| `paper` | `gain: 3` |\n"
            "\n## Expert settings\n\nThe defaults are meant to stay: these are for research, and "
            "for a fault that has been understood.\n\n"
            "| key | type | default | unit | range | meaning |\n|---|---|---|---|---|---|\n"
            "| `gain` " +
                row +
                "| `wheel` | group |  |  |  | the only one |\n"
                "| `wheel.radius_m` | number | `0.1` | m | 0.01 to 1 | of the tyre |\n"
                "| `wheel.color` | one of `red`, `green` | `red` |  |  | red \\| green |\n"
                "\n## Lists\n\nWhat the items of lists hold.\n\n"
                "| key | type | default | unit | range | meaning |\n|---|---|---|---|---|---|\n"
                "| `spares` | list | `[]` |  |  | more |\n"
                "| `spares[].radius_m` | number | `0.1` | m | 0.01 to 1 | of the tyre |\n"
                "| `spares[].color` | one of `red`, `green` | `red` |  |  | red \\| green |\n");
}

TEST(ReadConfig, ListsTheKeysOfUsersBeforeThoseOfExperts) {
  try {
    (void)read_config<TieredConfig>(parse_yaml("abracadabra: 1", "f"), "f");
    FAIL() << "read an unknown key";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("known keys are: speed_mps; and for experts: gain, wheel, spares"));
  }
}

}  // namespace
}  // namespace strata::settings
