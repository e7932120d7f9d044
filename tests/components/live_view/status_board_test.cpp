// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/status_board.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/live_view/metric_reader.hpp"

namespace strata::live_view {
namespace {

using diagnostic_msgs::msg::DiagnosticArray;
using diagnostic_msgs::msg::DiagnosticStatus;
using testing::Contains;
using testing::IsEmpty;
using testing::Key;
using testing::Not;
using testing::Pair;
using Values = std::vector<std::pair<std::string, std::string>>;

constexpr StatusBoard::Clock::time_point kBegin{std::chrono::hours(100)};

DiagnosticArray array_of(const std::string& name, const Values& values,
                         const std::string& hardware = "strata") {
  DiagnosticStatus status;
  status.name(name);
  status.hardware_id(hardware);
  status.level(1);
  for (const auto& [key, value] : values) {
    diagnostic_msgs::msg::KeyValue entry;
    entry.key(key);
    entry.value(value);
    status.values().push_back(entry);
  }
  DiagnosticArray array;
  array.status().push_back(status);
  return array;
}

std::map<std::string, double> samples_of(const StatusBoard& board,
                                         StatusBoard::Clock::time_point now = kBegin) {
  MetricText metrics;
  board.write(metrics, now);
  return test::MetricReader(true).read(metrics.text(MetricFormat::kOpenMetrics)).samples;
}

TEST(StatusBoard, MakesMetricsOfWhatALocalizerSays) {
  StatusBoard board;
  board.take(
      array_of("robot/localizer: health", {{"state", "active"},
                                           {"processed", "1200"},
                                           {"skipped", "3"},
                                           {"dropped", "2"},
                                           {"scans that came too late", "5"},
                                           {"received /robot/scan", "1205"},
                                           {"lost /robot/scan", "7"},
                                           {"work times /robot/scan", "0.1:1200 inf:1200 sum:9"},
                                           {"update times", "0.1:1199 inf:1200 sum:8"},
                                           {"model", "patch"},
                                           {"maps", "/maps/hall"},
                                           {"mapHash", "0badc0de"},
                                           {"verdict", "map_outdated"},
                                           {"localizationScore", "0.625"},
                                           {"localized", "true"},
                                           {"deviationRange", "0.12"}}),
      kBegin);
  const auto samples = samples_of(board);
  const std::string who = "component=\"/robot/localizer\"";
  const auto expect = [&](const std::string& name, const std::string& labels, double value) {
    EXPECT_THAT(samples, Contains(Pair(name + "{" + who + labels + "}", value)));
  };
  expect("strata_component_up", "", 1.0);
  expect("strata_component_level", "", 1.0);
  expect("strata_component_active", "", 1.0);
  expect("strata_component_messages_processed_total", "", 1200.0);
  expect("strata_component_failures_total", "", 3.0);
  expect("strata_component_messages_left_out_total", ",reason=\"too_busy\"", 2.0);
  expect("strata_component_messages_left_out_total", ",reason=\"scan_too_late\"", 5.0);
  expect("strata_topic_received_messages_total", ",topic=\"/robot/scan\"", 1205.0);
  expect("strata_topic_lost_messages_total", ",topic=\"/robot/scan\"", 7.0);
  expect("strata_component_work_seconds_count", ",topic=\"/robot/scan\"", 1200.0);
  expect("strata_localization_update_seconds_bucket", ",le=\"0.1\"", 1199.0);
  expect("strata_localization_map_info", ",model=\"patch\",maps=\"/maps/hall\",sha256=\"0badc0de\"",
         1.0);
  expect("strata_localization_verdict", ",verdict=\"map_outdated\"", 1.0);
  expect("strata_localization_verdict", ",verdict=\"lost\"", 0.0);
  expect("strata_localization_score", "", 0.625);
  expect("strata_localization_localized", "", 1.0);
  expect("strata_localization_deviation_range_meters", "", 0.12);
}

TEST(StatusBoard, KeepsTheNewestStatusOnly) {
  StatusBoard board;
  board.take(array_of("a: health", {{"processed", "1"}, {"places", "4"}}), kBegin);
  board.take(array_of("a: health", {{"processed", "2"}}), kBegin);
  const auto samples = samples_of(board);
  EXPECT_THAT(samples,
              Contains(Pair("strata_component_messages_processed_total{component=\"/a\"}", 2.0)));
  EXPECT_THAT(samples, Not(Contains(Key("strata_localization_places{component=\"/a\"}"))));
}

TEST(StatusBoard, SaysThatAComponentIsSilentAndNothingOldOfIt) {
  StatusBoard board;
  board.take(array_of("a: health", {{"processed", "1"}}), kBegin);
  EXPECT_EQ(
      samples_of(board, kBegin + StatusBoard::kSilent).at("strata_component_up{component=\"/a\"}"),
      1.0);
  const auto silent = samples_of(board, kBegin + StatusBoard::kSilent + std::chrono::seconds(1));
  EXPECT_THAT(silent, testing::ElementsAre(Pair("strata_component_up{component=\"/a\"}", 0.0)));
  EXPECT_THAT(samples_of(board, kBegin + std::chrono::hours(2)), IsEmpty());
}

TEST(StatusBoard, LeavesOutWhatIsNotOursAndNoNumber) {
  StatusBoard board;
  board.take(array_of("battery: health", {{"processed", "1"}}, "acme"), kBegin);
  board.take(array_of("a: voltage", {{"processed", "1"}}), kBegin);
  EXPECT_THAT(samples_of(board), IsEmpty());
  board.take(array_of("a: health", {{"processed", "many"},
                                    {"particles", "1e999"},
                                    {"received no topic", "1"},
                                    {"update times", "long"},
                                    {"something of its own", "1"}}),
             kBegin);
  EXPECT_THAT(samples_of(board),
              testing::UnorderedElementsAre(Key("strata_component_up{component=\"/a\"}"),
                                            Key("strata_component_level{component=\"/a\"}"),
                                            Key("strata_component_active{component=\"/a\"}")));
}

TEST(StatusBoard, IsBoundedWhoeverSendsWhatever) {
  StatusBoard board;
  Values topics;
  for (int i = 0; i < 3000; ++i) topics.emplace_back("received /" + std::to_string(i), "1");
  for (int i = 0; i < 1000; ++i) {
    board.take(array_of(std::to_string(i) + ": health", i == 0 ? topics : Values()), kBegin);
  }
  std::size_t up = 0;
  std::size_t received = 0;
  for (const auto& [head, value] : samples_of(board)) {
    if (head.starts_with("strata_component_up")) ++up;
    if (head.starts_with("strata_topic_received")) ++received;
  }
  EXPECT_EQ(up, StatusBoard::kMaxComponents);
  EXPECT_EQ(received, StatusBoard::kMaxEntries);
  // Those that are silent for long make room.
  board.take(array_of("new: health", {}), kBegin + std::chrono::hours(2));
  EXPECT_THAT(samples_of(board, kBegin + std::chrono::hours(2)),
              Contains(Key("strata_component_up{component=\"/new\"}")));
}

TEST(ProcessMetrics, TellOfThisProcess) {
  MetricText metrics;
  write_process(metrics);
  const auto samples =
      test::MetricReader(true).read(metrics.text(MetricFormat::kOpenMetrics)).samples;
  EXPECT_GT(samples.at("process_resident_memory_bytes"), 1e6);
  EXPECT_GT(samples.at("process_cpu_seconds_total"), 0.0);
  EXPECT_GT(samples.at("process_open_fds"), 2.0);
}

}  // namespace
}  // namespace strata::live_view
