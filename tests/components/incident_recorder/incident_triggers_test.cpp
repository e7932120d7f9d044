// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/incident_triggers.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace strata::incident_recorder {
namespace {

diagnostic_msgs::msg::DiagnosticStatus status(
    const std::string& name, std::uint8_t level,
    const std::vector<std::pair<std::string, std::string>>& values = {}) {
  diagnostic_msgs::msg::DiagnosticStatus told;
  told.name(name);
  told.level(level);
  told.message("as told");
  for (const auto& [key, value] : values) {
    diagnostic_msgs::msg::KeyValue entry;
    entry.key(key);
    entry.value(value);
    told.values().push_back(entry);
  }
  return told;
}

diagnostic_msgs::msg::DiagnosticStatus verdict(const std::string& word, std::uint8_t level = 0) {
  return status("localizer: health", level, {{"verdict", word}});
}

diagnostic_msgs::msg::DiagnosticStatus score(const std::string& value) {
  return status("localizer: health", 0, {{"score", value}});
}

std::string kind(const std::optional<IncidentReason>& reason) {
  return reason ? reason->kind : "none";
}

TEST(IncidentTriggers, LostBeginsOneIncidentThoughItIsAnErrorToo) {
  IncidentTriggers triggers({});
  EXPECT_EQ(kind(triggers.take(verdict("good"))), "none");
  EXPECT_EQ(kind(triggers.take(verdict("lost", 2))), "lost");
  EXPECT_EQ(kind(triggers.take(verdict("lost", 2))), "none");
  EXPECT_EQ(kind(triggers.take(verdict("good"))), "none");
  EXPECT_EQ(kind(triggers.take(verdict("lost", 2))), "lost");
}

TEST(IncidentTriggers, AnOutdatedMapBeginsOneUnlessThatIsOff) {
  IncidentTriggers triggers({});
  (void)triggers.take(verdict("good"));
  EXPECT_EQ(kind(triggers.take(verdict("map_outdated", 1))), "outdated");
  IncidentTriggers off({.on_outdated = false});
  (void)off.take(verdict("good"));
  EXPECT_EQ(kind(off.take(verdict("map_outdated", 1))), "none");
}

TEST(IncidentTriggers, AnErrorOfAnybodyBeginsOneAndSoDoesOneWhoFellSilent) {
  IncidentTriggers triggers({});
  (void)triggers.take(status("lidar: driver", 0));
  const auto reason = triggers.take(status("lidar: driver", 2));
  EXPECT_EQ(kind(reason), "error");
  EXPECT_EQ(reason->text, "lidar: driver: as told");
  (void)triggers.take(status("base: watchdog", 1));
  EXPECT_EQ(kind(triggers.take(status("base: watchdog", 3))), "error");
  EXPECT_EQ(kind(triggers.take(status("base: watchdog", 2))), "none") << "it was one already";
}

TEST(IncidentTriggers, ARobotThatIsLookedForBeginsOneUnlessThatIsOff) {
  const auto recovering = [](const char* value) {
    return status("localizer: health", 1, {{"verdict", "good"}, {"recovering", value}});
  };
  IncidentTriggers triggers({});
  (void)triggers.take(recovering("false"));
  const auto reason = triggers.take(recovering("true"));
  EXPECT_EQ(kind(reason), "recovery");
  EXPECT_EQ(reason->text, "localizer: health doubts its pose and looks for the robot");
  EXPECT_EQ(kind(triggers.take(recovering("true"))), "none") << "it was one already";
  (void)triggers.take(recovering("false"));
  EXPECT_EQ(kind(triggers.take(recovering("true"))), "recovery");
  IncidentTriggers off({.on_recovery = false});
  (void)off.take(recovering("false"));
  EXPECT_EQ(kind(off.take(recovering("true"))), "none");
}

TEST(IncidentTriggers, WhatASourceSaysFirstBeginsNothing) {
  IncidentTriggers triggers({});
  EXPECT_EQ(kind(triggers.take(verdict("lost", 2))), "none");
  EXPECT_EQ(kind(triggers.take(status("lidar: driver", 2))), "none");
}

TEST(IncidentTriggers, AScoreThatWaversAboutTheThresholdBeginsOne) {
  IncidentTriggers triggers({.score_below = 0.3});
  int begun = 0;
  for (const char* value : {"0.10", "0.50", "0.20", "0.90", "0.31", "0.29", "0.31", "0.29", "0.5",
                            "0.1", "nan", "", "0.66", "0.2"}) {
    begun += kind(triggers.take(score(value))) == "score" ? 1 : 0;
  }
  EXPECT_EQ(begun, 2) << "after 0.90 and after 0.66";
  IncidentTriggers off({.score_below = 0.0});
  (void)off.take(score("0.9"));
  EXPECT_EQ(kind(off.take(score("0.0"))), "none");
}

TEST(IncidentTriggers, SourcesWithoutEndTakeNoMemory) {
  IncidentTriggers triggers({});
  for (std::size_t i = 0; i < 2 * IncidentTriggers::kMaxSources; ++i) {
    (void)triggers.take(status("source " + std::to_string(i), 0));
  }
  EXPECT_EQ(kind(triggers.take(status("source 0", 2))), "error");
  EXPECT_EQ(kind(triggers.take(status("source 1999", 2))), "none");
}

TEST(IncidentTriggers, ListenToTheirOwnRobotWhereSeveralShareATopic) {
  const IncidentTriggers everybody({});
  const IncidentTriggers own({}, "robot1/");
  const IncidentTriggers named({.sources = {"/localizer", "robot2", "arm/"}}, "robot1/");
  const auto wanted = [&](const std::string& name) {
    std::string by;
    if (everybody.wants(name)) by += "everybody ";
    if (own.wants(name)) by += "own ";
    if (named.wants(name)) by += "named ";
    return by;
  };
  EXPECT_EQ(wanted("robot1/localizer: health"), "everybody own ");
  EXPECT_EQ(wanted("robot2/localizer: health"), "everybody named ");
  EXPECT_EQ(wanted("robot2: battery"), "everybody own named ") << "drivers tell no namespace";
  EXPECT_EQ(wanted("robot21/localizer: health"), "everybody ");
  EXPECT_EQ(wanted("localizer: health"), "everybody own named ");
  EXPECT_EQ(wanted("arm/wrist: health"), "everybody named ");
}

TEST(IncidentTriggers, OfAnotherRobotBeginNothing) {
  IncidentTriggers triggers({}, "robot1/");
  for (const std::uint8_t level : {0, 2}) {
    EXPECT_EQ(kind(triggers.take(status("robot2/localizer: health", level))), "none");
  }
  (void)triggers.take(status("robot1/localizer: health", 0));
  EXPECT_EQ(kind(triggers.take(status("robot1/localizer: health", 2))), "error");
}

}  // namespace
}  // namespace strata::incident_recorder
