// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/localizer/config.hpp"
#include "components/settings/yaml_document.hpp"
#include "core/base/error.hpp"

namespace strata::runtime {
namespace {

using rcl_interfaces::msg::Parameter;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

enum class Colour { kRed, kGreen };

struct Inner {
  double weight_kg = 1.5;
  std::vector<double> limits = {1.0, 2.0};
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("weight_kg", c.weight_kg, {.doc = "how heavy", .unit = "kg", .min = 0.0, .max = 9.0});
    v.field("limits", c.limits, {});
  }
};

}  // namespace
}  // namespace strata::runtime

template <>
struct strata::EnumNames<strata::runtime::Colour> {
  static constexpr std::array<std::pair<strata::runtime::Colour, const char*>, 2> values = {
      {{strata::runtime::Colour::kRed, "red"}, {strata::runtime::Colour::kGreen, "green"}}};
};

namespace strata::runtime {
namespace {

struct Sample {
  bool on = true;
  int count = 3;
  std::string name = "a";
  Colour colour = Colour::kGreen;
  Inner inner;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("on", c.on, {});
    v.field("count", c.count, {.min = 1.0});
    v.field("name", c.name, {});
    v.field("colour", c.colour, {});
    v.group("inner", c.inner, "");
    v.require(c.count != 13, "count", "is 13", "choose another");
    v.renamed("amount", "count");
    v.renamed("within", "inner");
    v.removed("shape", "there is one only");
  }
};

template <typename T>
Parameter change(const std::string& name, const T& value) {
  Parameter result;
  result.name(name);
  result.value(parameter_value(value));
  return result;
}

/// A component with this config, of which `on` and `inner.weight_kg` are live.
struct Holder {
  Sample active;
  YAML::Node yaml = YAML::Node(YAML::NodeType::Map);
  ParameterModel model{
      [](const YAML::Node& node) {
        return parameter_table(settings::read_config<Sample>(node, "test"));
      },
      [this](const YAML::Node& node) { active = settings::read_config<Sample>(node, "test"); },
      {"on", "inner.weight_kg"},
      settings::key_tree<Sample>()};
  ParameterChange set(const std::vector<Parameter>& changes) {
    return change_parameters(model, changes, yaml);
  }
  [[nodiscard]] Sample configured() const { return settings::read_config<Sample>(yaml, "test"); }
};

TEST(Parameters, AreTheFieldsOfTheConfigWithTypesRangesAndWords) {
  const ParameterTable table = parameter_table(Sample());
  std::vector<std::string> names;
  for (const ParameterEntry& entry : table) names.push_back(entry.descriptor.name());
  EXPECT_THAT(names,
              ElementsAre("on", "count", "name", "colour", "inner.weight_kg", "inner.limits"));
  EXPECT_EQ(find_parameter(table, "on")->value.type(), 1);
  EXPECT_EQ(find_parameter(table, "count")->value.integer_value(), 3);
  EXPECT_EQ(find_parameter(table, "count")->descriptor.integer_range()[0].from_value(), 1);
  EXPECT_EQ(find_parameter(table, "colour")->value.string_value(), "green");
  EXPECT_EQ(find_parameter(table, "colour")->descriptor.additional_constraints(),
            "one of red, green");
  const ParameterEntry& weight = *find_parameter(table, "inner.weight_kg");
  EXPECT_EQ(weight.value.double_value(), 1.5);
  EXPECT_EQ(weight.descriptor.description(), "how heavy [kg]; an expert setting");
  EXPECT_EQ(weight.descriptor.floating_point_range()[0].to_value(), 9.0);
  EXPECT_THAT(find_parameter(table, "inner.limits")->value.double_array_value(),
              ElementsAre(1.0, 2.0));
}

TEST(Parameters, AreListedByPrefixAndDepthAsRos2Does) {
  const ParameterTable table = parameter_table(Sample());
  EXPECT_EQ(list_parameters(table, {}, 0).names().size(), 6U);
  EXPECT_THAT(list_parameters(table, {}, 0).prefixes(), ElementsAre("inner"));
  EXPECT_THAT(list_parameters(table, {}, 1).names(), ElementsAre("on", "count", "name", "colour"));
  EXPECT_THAT(list_parameters(table, {"inner"}, 0).names(),
              ElementsAre("inner.weight_kg", "inner.limits"));
  EXPECT_THAT(list_parameters(table, {"inn"}, 0).names(), IsEmpty());
}

TEST(Parameters, ThatAreLiveChangeAtOnce) {
  Holder holder;
  const ParameterChange outcome = holder.set({change("inner.weight_kg", 2.0)});
  EXPECT_TRUE(outcome.ok);
  EXPECT_EQ(outcome.reason, "");
  EXPECT_EQ(holder.active.inner.weight_kg, 2.0);
}

TEST(Parameters, ThatAreNotLiveWaitForTheNextConfigureAndSaySo) {
  Holder holder;
  const ParameterChange outcome = holder.set({change("count", std::int64_t{7})});
  EXPECT_TRUE(outcome.ok);
  EXPECT_THAT(outcome.reason, HasSubstr("configured again"));
  EXPECT_EQ(holder.active.count, 3);
  EXPECT_EQ(holder.configured().count, 7);
}

TEST(Parameters, ThatAreLiveSayWhatOfThemCouldNotBeDone) {
  Holder holder;
  holder.model.apply_live = [](const YAML::Node&) {
    throw OutputError("a bag", "cannot be written", "free some space");
  };
  const ParameterChange outcome = holder.set({change("on", false)});
  EXPECT_TRUE(outcome.ok) << "part of it may have been done";
  EXPECT_THAT(outcome.reason, HasSubstr("not all of it could be done: cannot be written; free "));
  EXPECT_FALSE(holder.configured().on);
}

TEST(Parameters, OfEachTypeComeThroughYamlUnchanged) {
  Holder holder;
  ASSERT_TRUE(holder
                  .set({change("on", false), change("name", std::string("x: 'y'")),
                        change("colour", std::string("red")),
                        change("inner.limits", std::vector<double>{0.1, 1.0 / 3.0}),
                        change("inner.weight_kg", 0.1)})
                  .ok);
  const Sample now = holder.configured();
  EXPECT_FALSE(now.on);
  EXPECT_EQ(now.name, "x: 'y'");
  EXPECT_EQ(now.colour, Colour::kRed);
  EXPECT_THAT(now.inner.limits, ElementsAre(0.1, 1.0 / 3.0));
  EXPECT_EQ(now.inner.weight_kg, 0.1);
}

TEST(Parameters, TakeAWholeNumberForADoubleButNoOtherType) {
  Holder holder;
  EXPECT_TRUE(holder.set({change("inner.weight_kg", std::int64_t{4})}).ok);
  EXPECT_EQ(holder.active.inner.weight_kg, 4.0);
  EXPECT_FALSE(holder.set({change("count", 2.0)}).ok);
  EXPECT_FALSE(holder.set({change("name", true)}).ok);
}

TEST(Parameters, RefuseWhatTheConfigRefusesAndStayAsTheyWere) {
  Holder holder;
  EXPECT_THAT(holder.set({change("inner.weight_kg", 10.0)}).reason, HasSubstr("9"));
  EXPECT_THAT(holder.set({change("count", std::int64_t{13})}).reason, HasSubstr("is 13"));
  EXPECT_THAT(holder.set({change("colour", std::string("blue"))}).reason, Not(IsEmpty()));
  EXPECT_THAT(holder.set({change("cuont", std::int64_t{2})}).reason, HasSubstr("cuont"));
  // All or none.
  EXPECT_FALSE(holder.set({change("on", false), change("count", std::int64_t{0})}).ok);
  EXPECT_TRUE(holder.configured().on);
  EXPECT_TRUE(holder.active.on);
  EXPECT_EQ(holder.configured().count, 3);
}

TEST(Parameters, AreSetByTheirOldNamesAndSaySo) {
  Holder holder;
  const ParameterChange later = holder.set({change("amount", std::int64_t{7})});
  EXPECT_TRUE(later.ok);
  EXPECT_THAT(later.reason, HasSubstr("amount is called count now"));
  EXPECT_EQ(holder.configured().count, 7);
  const ParameterChange live = holder.set({change("within.weight_kg", 2.0)});
  EXPECT_TRUE(live.ok);
  EXPECT_THAT(live.reason, HasSubstr("inner.weight_kg now"));
  EXPECT_EQ(holder.active.inner.weight_kg, 2.0);
  EXPECT_FALSE(holder.set({change("shape", std::string("round"))}).ok);
}

TEST(Parameters, OfARealComponentHaveDescriptors) {
  const ParameterTable table = parameter_table(localizer::LocalizerComponentConfig());
  EXPECT_GT(table.size(), 30U);
  for (const ParameterEntry& entry : table) {
    EXPECT_NE(entry.value.type(), 0) << entry.descriptor.name();
  }
}

}  // namespace
}  // namespace strata::runtime
