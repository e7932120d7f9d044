// SPDX-License-Identifier: Apache-2.0
/// The metrics of /metrics, and which entries of /diagnostics they are read from.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace strata::live_view {

enum class MetricType : std::uint8_t { kGauge, kCounter, kHistogram, kInfo };

struct MetricFamily {
  std::string_view name;  ///< without the "_total" of counters and the "_info" of infos
  MetricType type = MetricType::kGauge;
  std::string_view unit;    ///< a base unit, which the name ends with; empty: it has none
  std::string_view labels;  ///< beside `component`, separated by ", "
  std::string_view help;    ///< one sentence
};

/// As OpenMetrics names the type.
[[nodiscard]] std::string_view type_name(MetricType type);
/// What the name of a sample has behind the family's: "_total", "_info" or nothing.
[[nodiscard]] std::string_view suffix_of(MetricType type);

/// All, in the order they are written.
[[nodiscard]] std::span<const MetricFamily> metric_families();

/// How the text of an entry becomes samples.
enum class FigureKind : std::uint8_t {
  kNumber,
  kTruth,        ///< "true" is 1, what else there is 0
  kTimes,        ///< runtime::TimeHistogram::text
  kTopicNumber,  ///< the key goes on with a topic, which becomes a label
  kTopicTimes,   ///< both
};

/// An entry of a component's status.
struct StatusFigure {
  std::string_view key;
  std::string_view family;
  FigureKind kind = FigureKind::kNumber;
  std::string_view label = {};  ///< with `value`: one more label of the sample
  std::string_view value = {};
  double scale = 1.0;
};

/// The entries that are known; others are left out.
[[nodiscard]] std::span<const StatusFigure> status_figures();

}  // namespace strata::live_view
