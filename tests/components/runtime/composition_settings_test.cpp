// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/composition_settings.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/runtime/composition.hpp"
#include "components/runtime/stand_in.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace strata::runtime {
namespace {

using testing::HasSubstr;

class CompositionSettings : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path() / "c.yaml")
        << "version: 1\nnamespace: /robot1\nprocesses:\n  - name: main\n    components:\n"
           "      - {type: t, name: localizer, parameters: {model: patch, input: {a: 1, b: 2}}}\n"
           "      - {type: t, name: localizer, namespace: /robot2}\n"
           "      - {type: t, name: matcher}\n";
  }
  [[nodiscard]] Composition with(const std::string& text,
                                 const std::vector<std::string>& overrides = {}) const {
    std::ofstream(folder_.path() / "s.yaml") << text;
    return load_composition(folder_.path() / "c.yaml", overrides, folder_.path() / "s.yaml");
  }
  [[nodiscard]] std::string complaint_about(const std::string& text) const {
    try {
      (void)with(text);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no complaint";
  }
  static std::string parameter(const Composition& composition, std::size_t component,
                               const char* key) {
    const YAML::Node& parameters = composition.processes[0].components[component].parameters;
    return parameters[key].IsDefined() ? parameters[key].as<std::string>() : "absent";
  }

 protected:
  strata::test::TemporaryDirectory folder_;
};

TEST_F(CompositionSettings, AFileThatReplacesTheProcessesSetsItsOwnComponentsWhereverTheyStand) {
  const Composition composition = with(
      "version: 1\nplanner: {speed: 3}\nprocesses:\n  - name: main\n    components:\n"
      "      - {type: t, name: planner}\n");
  EXPECT_EQ(parameter(composition, 0, "speed"), "3");
  EXPECT_THAT(complaint_about("version: 1\nprocesses: loopback\nlocalizer: {model: patch}\n"),
              HasSubstr("'localizer' is neither a component nor a key of the composition"));
}

TEST_F(CompositionSettings, OwnFormSetsComponentsByNameAndKeysOfTheComposition) {
  const Composition composition = with(
      "version: 1\ndomain: 7\nlocalizer: {model: filtered, input: {b: 3}}\n"
      "/robot2/localizer: {model: occupancy}\n");
  EXPECT_EQ(composition.network.domain, 7);
  EXPECT_EQ(parameter(composition, 0, "model"), "filtered");
  EXPECT_EQ(parameter(composition, 1, "model"), "occupancy");
  EXPECT_EQ(parameter(composition, 2, "model"), "absent");
  const YAML::Node input = composition.processes[0].components[0].parameters["input"];
  EXPECT_EQ(input["a"].as<int>(), 1);
  EXPECT_EQ(input["b"].as<int>(), 3);
}

TEST_F(CompositionSettings, RosParameterFilesGoByFullNameNameAndForAll) {
  const Composition composition = with(
      "/robot2/localizer:\n  ros__parameters: {model: occupancy, use_sim_time: true}\n"
      "localizer:\n  ros__parameters:\n    model: filtered\n    input.b: 4\n"
      "robot1:\n  matcher:\n    ros__parameters: {model: nested}\n"
      "/**:\n  ros__parameters: {map_frame: floor}\n");
  EXPECT_EQ(parameter(composition, 0, "model"), "filtered");
  EXPECT_EQ(parameter(composition, 1, "model"), "occupancy") << "the full name wins";
  EXPECT_EQ(parameter(composition, 1, "use_sim_time"), "true") << "every component has it";
  EXPECT_EQ(parameter(composition, 2, "model"), "nested");
  const ComponentEntry& first = composition.processes[0].components[0];
  EXPECT_EQ(first.parameters["input"]["b"].as<int>(), 4);
  EXPECT_EQ(first.parameters["input"]["a"].as<int>(), 1);
  EXPECT_EQ(first.common_parameters["map_frame"].as<std::string>(), "floor");
  EXPECT_EQ(parameter(composition, 0, "map_frame"), "absent") << "only for those that know it";
}

TEST_F(CompositionSettings, RosParametersOfOtherNodesAreNotedAndLeftOut) {
  const Composition composition = with(
      "bt_navigator:\n  ros__parameters: {plugins: [a]}\n"
      "matcher:\n  ros__parameters: {model: ours}\n"
      "local_costmap:\n  local_costmap:\n    ros__parameters: {width: 3}\n"
      "/robot3/localizer:\n  ros__parameters: {model: of another robot}\n"
      "/robot9/*:\n  ros__parameters: {model: of others}\n");
  EXPECT_EQ(parameter(composition, 0, "model"), "patch");
  EXPECT_EQ(parameter(composition, 2, "model"), "ours");
  ASSERT_EQ(composition.notes.size(), 1U);
  EXPECT_THAT(composition.notes[0], HasSubstr("s.yaml: for no component of the composition: "
                                              "bt_navigator, local_costmap/local_costmap, "
                                              "/robot3/localizer, /robot9/*"));
  EXPECT_THAT(with("matcher:\n  ros__parameters: {model: a}\n").notes, testing::IsEmpty());
  EXPECT_THAT(with("bt_navigator:\n  ros__parameters: {a: 1}\n").notes, testing::SizeIs(1));
}

/// Somebody's node `other`, whose `speed` is our input.a.
StandIns other_stand_ins() {
  return {{"other", "t", {"speed", "kind.of"}, [](Translator& translator) {
             translator.map_as_it_is<double>("speed", "input.a");
             translator.ignore("kind.of", "there is one kind");
           }}};
}

TEST_F(CompositionSettings, AComponentTakesWhatIsForTheNodeThatItStandsInFor) {
  const auto input_of = [](const Composition& composition, std::size_t component) {
    const YAML::Node parameters = composition.processes[0].components[component].parameters;
    return parameters["input"].IsDefined() ? parameters["input"]["a"].as<std::string>() : "absent";
  };
  const auto standing_in = [this](const std::string& text) {
    std::ofstream(folder_.path() / "s.yaml") << text;
    return load_composition(folder_.path() / "c.yaml", {}, folder_.path() / "s.yaml",
                            other_stand_ins());
  };
  // In /robot2 there is one of the type, in /robot1 there are two.
  const Composition composition = standing_in(
      "other:\n  ros__parameters: {speed: 2.5, kind: {of: 1}}\n"
      "bt_navigator:\n  ros__parameters: {a: 1}\n");
  EXPECT_EQ(input_of(composition, 1), "2.5");
  EXPECT_EQ(input_of(composition, 0), "1");
  EXPECT_EQ(input_of(composition, 2), "absent");
  ASSERT_EQ(composition.notes.size(), 3U);
  EXPECT_THAT(composition.notes[0],
              HasSubstr("s.yaml: for no component of the composition: bt_navigator"));
  EXPECT_THAT(composition.notes[1], HasSubstr("s.yaml:1: other is for none of several that could "
                                              "be /robot1/other; name one of them other"));
  EXPECT_THAT(composition.notes[2],
              HasSubstr("what is for other is for /robot2/localizer: 1 parameters mapped, 0 given "
                        "otherwise, 1 without meaning"));
  // By its full name it is for that namespace; a pattern for all nodes is for none in particular.
  EXPECT_EQ(input_of(standing_in("/robot2/other:\n  ros__parameters: {speed: 3}\n"), 1), "3");
  EXPECT_EQ(input_of(standing_in("/robot9/other:\n  ros__parameters: {speed: 3}\n"), 1), "absent");
  EXPECT_EQ(input_of(standing_in("/robot2/*:\n  ros__parameters: {speed: 3}\n"), 1), "absent");
  // The more specific entry wins.
  EXPECT_EQ(input_of(standing_in("/robot2/other:\n  ros__parameters: {speed: 4}\n"
                                 "other:\n  ros__parameters: {speed: 5}\n"),
                     1),
            "4");
}

TEST_F(CompositionSettings, WithoutStandInsWhatIsForOtherNodesIsLeftOut) {
  const Composition composition = with("other:\n  ros__parameters: {speed: 2.5}\n");
  EXPECT_EQ(parameter(composition, 1, "input"), "absent");
  EXPECT_THAT(composition.notes, testing::SizeIs(1));
}

TEST_F(CompositionSettings, RosParameterFilesSpellTrueAndFalseAsRos2Does) {
  const Composition composition = with(
      "localizer:\n  ros__parameters: {a: True, b: 'True', c: off, d: [yes, No], e: {f: FALSE}}\n");
  const YAML::Node parameters = composition.processes[0].components[1].parameters;
  EXPECT_EQ(parameters["a"].as<std::string>(), "true");
  EXPECT_EQ(parameters["b"].as<std::string>(), "True") << "a text";
  EXPECT_EQ(parameters["c"].as<std::string>(), "false");
  EXPECT_EQ(parameters["d"][0].as<std::string>(), "true");
  EXPECT_EQ(parameters["d"][1].as<std::string>(), "false");
  EXPECT_EQ(parameters["e"]["f"].as<std::string>(), "false");
  EXPECT_EQ(parameter(with("version: 1\nmatcher: {a: True}\n"), 2, "a"), "True")
      << "in our own form as it was";
}

TEST_F(CompositionSettings, RosWildcardsStandForOneSegmentOrForAnyNumber) {
  const auto models = [this](const std::string& entries) {
    const Composition composition = with(entries);
    std::vector<std::string> result;
    for (std::size_t i = 0; i < 3; ++i) result.push_back(parameter(composition, i, "model"));
    return result;
  };
  const auto for_nodes = [](const std::string& pattern, const std::string& model) {
    return pattern + ":\n  ros__parameters: {model: " + model + "}\n";
  };
  using testing::ElementsAre;
  EXPECT_THAT(models(for_nodes("/*/localizer", "x")), ElementsAre("x", "x", "absent"));
  EXPECT_THAT(models(for_nodes("/**/matcher", "x")), ElementsAre("patch", "absent", "x"));
  EXPECT_THAT(models(for_nodes("/*/*/localizer", "x")), ElementsAre("patch", "absent", "absent"));
  EXPECT_THAT(models("/**:\n  matcher:\n    ros__parameters: {model: x}\n"),
              ElementsAre("patch", "absent", "x"))
      << "as a group";
  // The more specific wins wherever it stands; of two alike the later.
  EXPECT_THAT(models(for_nodes("/robot1/localizer", "c") + for_nodes("/*/localizer", "b") +
                     for_nodes("/**/localizer", "a")),
              ElementsAre("c", "b", "absent"));
  EXPECT_THAT(models(for_nodes("/**/localizer", "b") + for_nodes("localizer", "a")),
              ElementsAre("a", "a", "absent"));
}

TEST_F(CompositionSettings, RosEntriesForANamespaceAreForThoseThatKnowThem) {
  const Composition composition = with(
      "/robot1/*:\n  ros__parameters: {map_frame: one}\n"
      "/**:\n  ros__parameters: {map_frame: all, odom_frame: all}\n");
  const auto common = [&](std::size_t component, const char* key) {
    return composition.processes[0].components[component].common_parameters[key].as<std::string>();
  };
  EXPECT_EQ(common(0, "map_frame"), "one");
  EXPECT_EQ(common(1, "map_frame"), "all");
  EXPECT_EQ(common(2, "odom_frame"), "all");
  EXPECT_EQ(parameter(composition, 0, "map_frame"), "absent");
}

TEST_F(CompositionSettings, WhatIsForOneComponentDoesNotReachAnotherThroughASharedEntry) {
  const Composition composition = with(
      "localizer:\n  ros__parameters: {group: {a: 1}}\n"
      "/robot2/localizer:\n  ros__parameters: {group: {a: 2}}\n");
  const auto& components = composition.processes[0].components;
  EXPECT_EQ(components[0].parameters["group"]["a"].as<int>(), 1);
  EXPECT_EQ(components[1].parameters["group"]["a"].as<int>(), 2);
}

// A robot may well have a node `localizer2` or `matchers` of somebody else's.
TEST_F(CompositionSettings, ANameLikeThatOfAComponentWithItsOwnEntryIsAnotherNodes) {
  const Composition composition = with(
      "localizer:\n  ros__parameters: {model: mine}\n"
      "/robot1/localiser:\n  ros__parameters: {model: theirs}\n");
  EXPECT_EQ(parameter(composition, 0, "model"), "mine");
  EXPECT_THAT(composition.notes, testing::ElementsAre(HasSubstr("/robot1/localiser")));
  // What is for all nodes names none.
  EXPECT_THAT(complaint_about("/**:\n  ros__parameters: {a: 1}\n"
                              "macher:\n  ros__parameters: {model: a}\n"),
              HasSubstr("did you mean 'matcher'?"));
}

// rcl_yaml_param_parser: "There are no node names before ros__parameters".
TEST_F(CompositionSettings, RefusesRosParametersBelowNoName) {
  const std::string complaint =
      complaint_about("localizer:\n  ros__parameters: {model: a}\nros__parameters: {model: b}\n");
  EXPECT_THAT(complaint, HasSubstr("s.yaml:3: ros__parameters is below no node's name"));
}

TEST_F(CompositionSettings, OptionsWinOverTheFile) {
  EXPECT_EQ(parameter(with("version: 1\nmatcher: {model: a}\n", {"matcher.model=b"}), 2, "model"),
            "b");
}

TEST_F(CompositionSettings, NamesWhatIsMeantByATypo) {
  const std::string own = complaint_about("version: 1\nlocaliser: {model: a}\n");
  EXPECT_THAT(own, HasSubstr("s.yaml:2"));
  EXPECT_THAT(own, HasSubstr("did you mean 'localizer'?"));
  EXPECT_THAT(complaint_about("localiser:\n  ros__parameters: {model: a}\n"),
              HasSubstr("did you mean 'localizer'?"));
  const std::string full = complaint_about(
      "/bt_navigator:\n  ros__parameters: {a: 1}\n"
      "/robot1/loaclizer:\n  ros__parameters: {model: a}\n");
  EXPECT_THAT(full, HasSubstr("s.yaml:3"));
  EXPECT_THAT(full, HasSubstr("did you mean '/robot1/localizer'?"));
  EXPECT_THAT(complaint_about("/**/macher:\n  ros__parameters: {model: a}\n"),
              HasSubstr("did you mean '/robot1/matcher'?"));
  EXPECT_THAT(complaint_about("/robto1/matcher:\n  ros__parameters: {model: a}\n"),
              HasSubstr("did you mean '/robot1/matcher'?"));
  EXPECT_THAT(complaint_about("localizer: {model: a}\n"), HasSubstr("has no version"));
  EXPECT_THAT(complaint_about("version: 1\ndomain: far\n"), HasSubstr("s.yaml:2"));
}

}  // namespace
}  // namespace strata::runtime
