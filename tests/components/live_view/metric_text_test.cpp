// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/metric_text.hpp"

#include <limits>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/runtime/time_histogram.hpp"
#include "core/base/config.hpp"
#include "tests/components/live_view/metric_reader.hpp"

namespace strata::live_view {
namespace {

using testing::HasSubstr;
using testing::Not;

test::ReadMetrics read(const MetricText& metrics, MetricFormat format) {
  return test::MetricReader(format == MetricFormat::kOpenMetrics).read(metrics.text(format));
}

TEST(MetricText, IsOpenMetricsWordForWord) {
  MetricText metrics;
  metrics.add("strata_component_up", {{"component", "/robot/localizer"}}, 1.0);
  metrics.add("process_cpu_seconds", {}, 12.5);
  metrics.add("strata_localization_map", {{"component", "/l"}, {"model", "patch"}}, 1.0);
  EXPECT_EQ(
      metrics.text(MetricFormat::kOpenMetrics),
      "# HELP strata_localization_map The map model, the MAPS folder it is from, and the SHA-256 "
      "of what that holds; "
      "\\\"topics\\\" and none where maps come by topics.\n"
      "# TYPE strata_localization_map info\n"
      "strata_localization_map_info{component=\"/l\",model=\"patch\"} 1\n"
      "# HELP strata_component_up 1 while the component's status comes, 0 when none came "
      "for 15 s.\n"
      "# TYPE strata_component_up gauge\n"
      "strata_component_up{component=\"/robot/localizer\"} 1\n"
      "# HELP process_cpu_seconds CPU time of this process.\n"
      "# TYPE process_cpu_seconds counter\n"
      "# UNIT process_cpu_seconds seconds\n"
      "process_cpu_seconds_total 12.5\n"
      "# EOF\n");
}

TEST(MetricText, NamesCountersByTheirSamplesInTheOlderFormat) {
  MetricText metrics;
  metrics.add("process_cpu_seconds", {}, 12.5);
  metrics.add("strata_localization_map", {{"model", "patch"}}, 1.0);
  const std::string text = metrics.text(MetricFormat::kPrometheusText);
  EXPECT_THAT(text, HasSubstr("# TYPE process_cpu_seconds_total counter\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE strata_localization_map_info gauge\n"));
  EXPECT_THAT(text, HasSubstr("\"topics\" and none where"));
}

TEST(MetricText, WritesHistogramsAsComponentsTellThem) {
  runtime::TimeHistogram times;
  for (const double time_s : {0.0001, 0.004, 0.7, 3.0}) times.add(time_s);
  HistogramCounts counts;
  ASSERT_TRUE(read_histogram(times.text(), counts));
  MetricText metrics;
  metrics.add("strata_component_work_seconds", {{"component", "/l"}, {"topic", "/scan"}}, counts);
  metrics.add("strata_localization_update_seconds", {}, counts);
  for (const MetricFormat format : {MetricFormat::kOpenMetrics, MetricFormat::kPrometheusText}) {
    const test::ReadMetrics found = read(metrics, format);
    const std::string name = "strata_component_work_seconds";
    const std::string labels = "component=\"/l\",topic=\"/scan\"";
    EXPECT_EQ(found.samples.at(name + "_bucket{" + labels + ",le=\"0.0005\"}"), 1.0);
    EXPECT_EQ(found.samples.at(name + "_bucket{" + labels + ",le=\"0.005\"}"), 2.0);
    EXPECT_EQ(found.samples.at(name + "_bucket{" + labels + ",le=\"1.0\"}"), 3.0);
    EXPECT_EQ(found.samples.at(name + "_count{" + labels + "}"), 4.0);
    EXPECT_EQ(found.samples.at(name + "_sum{" + labels + "}"), 3.7041);
  }
}

TEST(MetricText, TakesNoHistogramFromATextThatIsNone) {
  HistogramCounts counts;
  for (const char* text : {"", " ", "sum:1", "inf:1", "0.1:1 sum:1", "inf:1 sum:x", "inf:-1 sum:0",
                           "0.1:5 inf:4 sum:0", "x:1 inf:1 sum:1", "0.1 inf:1 sum:1",
                           "inf:nan sum:1", "inf:1 sum:inf", "inf:1  sum:1"}) {
    EXPECT_FALSE(read_histogram(text, counts)) << text;
  }
  EXPECT_TRUE(read_histogram("inf:1 sum:1", counts));
}

TEST(MetricText, StaysReadableWhateverALabelHolds) {
  MetricText metrics;
  const std::string wild = "a\"b\\c\nd\xff\xc3\xa4\t" + std::string(1000, 'x');
  metrics.add("strata_component_up", {{"component", wild}}, 1.0);
  const test::ReadMetrics found = read(metrics, MetricFormat::kOpenMetrics);
  ASSERT_EQ(found.samples.size(), 1U);
  EXPECT_THAT(found.samples.begin()->first, HasSubstr(R"("a\"b\\c\nd????xxx)"));
  EXPECT_LT(found.samples.begin()->first.size(), 300U);
}

TEST(MetricText, HasASampleOnceAndLeavesOutWhatIsNoNumberOfItsType) {
  MetricText metrics;
  metrics.add("strata_component_up", {}, 1.0);
  metrics.add("strata_component_up", {}, 0.0);
  metrics.add("strata_component_failures", {}, -1.0);
  metrics.add("strata_component_failures", {{"component", "/a"}},
              std::numeric_limits<double>::quiet_NaN());
  metrics.add("not_one_of_ours", {}, 1.0);
  metrics.add("strata_component_work_seconds", {}, 1.0);
  metrics.add("strata_localization_score", {}, std::numeric_limits<double>::quiet_NaN());
  const std::string text = metrics.text(MetricFormat::kOpenMetrics);
  EXPECT_THAT(text, HasSubstr("strata_component_up 1\n"));
  EXPECT_THAT(text, HasSubstr("strata_localization_score NaN\n"));
  EXPECT_THAT(text, Not(HasSubstr("strata_component_failures")));
  EXPECT_THAT(text, Not(HasSubstr("not_one_of_ours")));
  EXPECT_THAT(text, Not(HasSubstr("strata_component_work_seconds")));
}

TEST(MetricText, IsOpenMetricsForWhoAsksForIt) {
  // What Prometheus 2.42 sends, and browsers and curl.
  EXPECT_EQ(format_for("application/openmetrics-text;version=1.0.0;q=0.75,"
                       "text/plain;version=0.0.4;q=0.5,*/*;q=0.1"),
            MetricFormat::kOpenMetrics);
  EXPECT_EQ(format_for("text/html,*/*;q=0.8"), MetricFormat::kPrometheusText);
  EXPECT_EQ(format_for(""), MetricFormat::kPrometheusText);
}

TEST(MetricFamilies, HaveBaseUnitsAndHelpAndEachOnce) {
  std::set<std::string_view> names;
  for (const MetricFamily& family : metric_families()) {
    EXPECT_TRUE(names.insert(family.name).second) << family.name;
    EXPECT_TRUE(family.help.ends_with('.')) << family.name;
    EXPECT_FALSE(family.name.ends_with("_total")) << family.name;
    for (const std::string_view unit : {"seconds", "bytes", "meters", "radians", "ratio"}) {
      EXPECT_EQ(family.unit == unit, family.name.ends_with("_" + std::string(unit))) << family.name;
    }
    EXPECT_TRUE(family.type != MetricType::kHistogram || family.unit == "seconds") << family.name;
  }
}

TEST(MetricFamilies, OfEveryFigureAreThere) {
  std::set<std::string_view> names;
  for (const MetricFamily& family : metric_families()) names.insert(family.name);
  for (const StatusFigure& figure : status_figures()) {
    EXPECT_TRUE(names.contains(figure.family)) << figure.key;
  }
}

}  // namespace
}  // namespace strata::live_view
