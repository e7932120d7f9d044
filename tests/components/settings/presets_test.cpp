// SPDX-License-Identifier: Apache-2.0
#include "components/settings/presets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"

namespace strata::settings {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct EngineConfig {
  int power = 1;
  bool is_loud = true;
  friend bool operator==(const EngineConfig&, const EngineConfig&) = default;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("power", c.power, {.doc = "", .max = 100, .preset = {"race", "9"}});
    v.field("is_loud", c.is_loud, {.doc = "", .preset = {"night", "false"}});
  }
};

struct CarConfig {
  std::string color = "red";
  EngineConfig engine;
  friend bool operator==(const CarConfig&, const CarConfig&) = default;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("color", c.color, {.doc = "", .preset = {"race", "green"}});
    v.group("engine", c.engine, "");
    v.renamed("motor", "engine");
  }
};

CarConfig read_car(const std::string& text, const std::vector<std::string>& overrides = {}) {
  YAML::Node document = parse_yaml(text, "car.yaml");
  apply_overrides(document, overrides);
  return read_config<CarConfig>(document, "car.yaml");
}

std::string error_of_preset(const std::string& text) {
  try {
    (void)read_car(text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Presets, SetWhatTheFieldsSayAndNothingElse) {
  EXPECT_EQ(read_car("preset: race"), (CarConfig{"green", {9, true}}));
  EXPECT_EQ(read_car("preset: night"), (CarConfig{"red", {1, false}}));
  EXPECT_EQ(read_car("preset: [race, night]"), (CarConfig{"green", {9, false}}));
  EXPECT_EQ(read_car("", {"preset=race"}), (CarConfig{"green", {9, true}}));
}

TEST(Presets, GiveWayToWhatStandsBesideThem) {
  EXPECT_EQ(read_car("preset: race\nengine: {power: 5}\n"), (CarConfig{"green", {5, true}}));
  EXPECT_EQ(read_car("engine: {is_loud: false}\npreset: race\n"), (CarConfig{"green", {9, false}}));
  EXPECT_EQ(read_car("engine:\npreset: race\n"), (CarConfig{"green", {9, true}}));
  EXPECT_EQ(read_car("color: blue", {"preset=race", "engine.power=3"}),
            (CarConfig{"blue", {3, true}}));
  EXPECT_EQ(read_car("preset: race\nmotor: {power: 5}\n"), (CarConfig{"green", {5, true}}))
      << "an old name";
}

TEST(Presets, ThatAreUnknownAreRefusedWithTheKnownOnes) {
  EXPECT_THAT(error_of_preset("color: red\npreset: rage"), HasSubstr("car.yaml:2: preset 'rage'"));
  EXPECT_THAT(error_of_preset("preset: rage"), HasSubstr("known presets are: night, race"));
  EXPECT_THAT(error_of_preset("preset: [race, rage]"), HasSubstr("'rage'"));
  EXPECT_THAT(error_of_preset("preset: {race: 1}"), HasSubstr("known presets are: night, race"));
  EXPECT_THAT(error_of_preset("preset: race\npreset: night"), HasSubstr("given twice"));
}

TEST(Presets, LeaveComplaintsAboutTheRestToTheReader) {
  EXPECT_THAT(error_of_preset("preset: race\nengine: 7"), HasSubstr("car.yaml:2"));
  EXPECT_THAT(error_of_preset("preset: race\nengine:\n  power: 101"), HasSubstr("car.yaml:3"));
  EXPECT_THAT(error_of_preset("preset: race\nengine:\n  powr: 1"), HasSubstr("car.yaml:3"));
}

TEST(Presets, DoNotChangeTheDocument) {
  const YAML::Node document = parse_yaml("preset: race\nengine: {is_loud: true}\n", "car.yaml");
  (void)read_config<CarConfig>(document, "car.yaml");
  EXPECT_EQ(document["preset"].Scalar(), "race");
  EXPECT_EQ(document["engine"].size(), 1U);
}

TEST(Presets, AreListedWithTheirKeys) {
  EXPECT_THAT(preset_names(key_tree<CarConfig>()), ElementsAre("night", "race"));
  const std::vector<PresetLine> lines = preset_lines(key_tree<CarConfig>());
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[1].key, "engine.power");
  EXPECT_EQ(lines[1].value, "9");
}

}  // namespace
}  // namespace strata::settings
