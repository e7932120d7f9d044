// SPDX-License-Identifier: Apache-2.0
/// A config struct with every kind of field, for the tests of settings.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/config.hpp"

namespace strata::test {
enum class Color { kRed, kGreen };
}  // namespace strata::test

template <>
struct strata::EnumNames<strata::test::Color> {
  static constexpr std::array<std::pair<strata::test::Color, const char*>, 2> values{
      {{strata::test::Color::kRed, "red"}, {strata::test::Color::kGreen, "green"}}};
};

namespace strata::test {

struct WheelConfig {
  double radius_m = 0.1;
  Color color = Color::kRed;
  friend bool operator==(const WheelConfig&, const WheelConfig&) = default;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("radius_m", c.radius_m, {.doc = "of the tyre", .unit = "m", .min = 0.01, .max = 1.0});
    v.field("color", c.color, {.doc = "red | green"});
  }
};

struct CartConfig {
  bool enabled = true;
  int seats = 4;
  std::int64_t offset = -3;
  std::uint64_t seed = 1;
  double length_m = 2.5;
  std::string name = "cart";
  std::vector<double> gains{0.5, 0.25};
  std::vector<int> sizes;
  std::vector<std::string> tags{"a"};
  WheelConfig spare;
  std::vector<WheelConfig> wheels;
  friend bool operator==(const CartConfig&, const CartConfig&) = default;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("enabled", c.enabled, {.doc = "whether it runs"});
    v.field("seats", c.seats, {.doc = "places", .min = 0});
    v.field("offset", c.offset, {.doc = "shift", .max = 10});
    v.field("seed", c.seed, {.doc = "of all randomness"});
    v.field("length_m", c.length_m, {.doc = "overall", .unit = "m", .min = 0.0});
    v.field("name", c.name, {.doc = "what it is called"});
    v.field("gains", c.gains, {.doc = "per stage", .min = 0.0, .max = 1.0});
    v.field("sizes", c.sizes, {.doc = "whole numbers"});
    v.field("tags", c.tags, {.doc = "words"});
    v.group("spare", c.spare, "the wheel on the back");
    v.list("wheels", c.wheels, "the wheels on the road");
    v.require(c.seats < 100, "seats", "are more than a cart has", "order a bus");
  }
};

}  // namespace strata::test
