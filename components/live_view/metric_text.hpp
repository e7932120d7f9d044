// SPDX-License-Identifier: Apache-2.0
/// Samples as a text that Prometheus reads: OpenMetrics 1.0, or its older text format 0.0.4.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/live_view/metric_families.hpp"

namespace strata::live_view {

enum class MetricFormat : std::uint8_t { kOpenMetrics, kPrometheusText };

/// What the scraper's Accept header asks for: OpenMetrics where it is named, else the older text,
/// which every tool reads.
[[nodiscard]] MetricFormat format_for(std::string_view accept);
/// For HTTP's Content-Type.
[[nodiscard]] std::string_view content_type(MetricFormat format);

using MetricLabels = std::vector<std::pair<std::string, std::string>>;

/// Counts up to each bound ("le"), the last of them "+Inf", and the sum.
struct HistogramCounts {
  std::vector<std::pair<std::string, double>> up_to;
  double sum = 0.0;
};
/// Reads runtime::TimeHistogram::text. False: it is none; then `counts` is of no use.
[[nodiscard]] bool read_histogram(std::string_view text, HistogramCounts& counts);

/// A number as both formats write it: "0.625", "NaN", "+Inf".
[[nodiscard]] std::string metric_number(double value);

/// Collects samples, then writes them family by family. Not thread safe.
class MetricText {
 public:
  /// Of the labels that a family's sample has already, the first value stays. What is no number of
  /// its type (a counter below 0 or not finite) is left out. family: one of metric_families().
  void add(std::string_view family, const MetricLabels& labels, double value);
  void add(std::string_view family, const MetricLabels& labels, const HistogramCounts& counts);

  /// Families without samples are left out. Ends with "# EOF", which is a comment in the older
  /// format. O(samples).
  [[nodiscard]] std::string text(MetricFormat format) const;

 private:
  /// By labels, as they are written; what stands behind the name, and the value.
  using Lines = std::vector<std::pair<std::string, std::string>>;
  std::map<std::string, std::map<std::string, Lines>, std::less<>> samples_;
};

}  // namespace strata::live_view
