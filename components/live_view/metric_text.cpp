// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/metric_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "components/log/text.hpp"

namespace strata::live_view {
namespace {

/// Longer values of labels are cut: they come from other hosts.
constexpr std::size_t kMaxLabelBytes = 256;

const MetricFamily* find_family(std::string_view name) {
  const auto families = metric_families();
  const auto found = std::find_if(families.begin(), families.end(),
                                  [&](const MetricFamily& one) { return one.name == name; });
  return found == families.end() ? nullptr : &*found;
}

/// The older format knows no infos.
std::string_view type_name_in(MetricFormat format, MetricType type) {
  const bool is_known = format == MetricFormat::kOpenMetrics || type != MetricType::kInfo;
  return type_name(is_known ? type : MetricType::kGauge);
}

/// Backslash, quote and newline escaped; what is no printable ASCII becomes "?": both formats are
/// UTF-8, and one wrong byte would make the scraper drop all.
std::string escaped(std::string_view value) {
  std::string text;
  for (const char c : value.substr(0, kMaxLabelBytes)) {
    if (c == '\n') {
      text += "\\n";
    } else if (c == '"' || c == '\\') {
      text += {'\\', c};
    } else {
      text += c >= ' ' && c <= '~' ? c : '?';
    }
  }
  return text;
}

std::string joined(const MetricLabels& labels) {
  std::string text;
  for (const auto& [name, value] : labels) {
    text += (text.empty() ? "" : ",") + name + "=\"" + escaped(value) + "\"";
  }
  return text;
}

std::string braced(const std::string& labels) { return labels.empty() ? "" : "{" + labels + "}"; }

}  // namespace

MetricFormat format_for(std::string_view accept) {
  return accept.find("application/openmetrics-text") != accept.npos ? MetricFormat::kOpenMetrics
                                                                    : MetricFormat::kPrometheusText;
}

std::string_view content_type(MetricFormat format) {
  return format == MetricFormat::kOpenMetrics
             ? "application/openmetrics-text; version=1.0.0; charset=utf-8"
             : "text/plain; version=0.0.4; charset=utf-8";
}

std::string metric_number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0.0 ? "+Inf" : "-Inf";
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

bool read_histogram(std::string_view text, HistogramCounts& counts) {
  counts = {};
  double before = 0.0;
  bool has_sum = false;
  while (!text.empty() && !has_sum) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    const std::size_t colon = word.find(':');
    if (colon == word.npos) return false;
    const std::string_view bound = word.substr(0, colon);
    const auto number = log::parse_double(word.substr(colon + 1));
    if (!number || !std::isfinite(*number) || *number < 0.0) return false;
    if (bound == "sum") {
      counts.sum = *number;
      has_sum = true;
    } else {
      const auto bound_value = log::parse_double(bound);
      if (*number < before || (bound != "inf" && !bound_value)) return false;
      // As a float, which is what OpenMetrics wants of a bound.
      std::string le = bound == "inf" ? "+Inf" : metric_number(*bound_value);
      if (bound != "inf" && le.find_first_of(".e") == std::string::npos) le += ".0";
      counts.up_to.emplace_back(std::move(le), *number);
      before = *number;
    }
  }
  return has_sum && !counts.up_to.empty() && counts.up_to.back().first == "+Inf";
}

void MetricText::add(std::string_view family, const MetricLabels& labels, double value) {
  const MetricFamily* known = find_family(family);
  if (known == nullptr || known->type == MetricType::kHistogram) return;
  if (known->type == MetricType::kCounter && (!std::isfinite(value) || value < 0.0)) return;
  const std::string key = joined(labels);
  const std::string head = std::string(suffix_of(known->type)) + braced(key);
  samples_[std::string(family)].try_emplace(key, Lines{{head, metric_number(value)}});
}

void MetricText::add(std::string_view family, const MetricLabels& labels,
                     const HistogramCounts& counts) {
  const MetricFamily* known = find_family(family);
  if (known == nullptr || known->type != MetricType::kHistogram) return;
  const std::string key = joined(labels);
  Lines lines;
  for (const auto& [bound, count] : counts.up_to) {
    const std::string le = "le=\"" + bound + "\"";
    lines.emplace_back("_bucket" + braced(key.empty() ? le : key + "," + le), metric_number(count));
  }
  lines.emplace_back("_count" + braced(key), metric_number(counts.up_to.back().second));
  lines.emplace_back("_sum" + braced(key), metric_number(counts.sum));
  samples_[std::string(family)].try_emplace(key, std::move(lines));
}

std::string MetricText::text(MetricFormat format) const {
  std::string text;
  for (const MetricFamily& family : metric_families()) {
    const auto found = samples_.find(family.name);
    if (found == samples_.end()) continue;
    const std::string name(family.name);
    // In the older format the name of a counter is that of its samples.
    const std::string told =
        format == MetricFormat::kOpenMetrics ? name : name + std::string(suffix_of(family.type));
    text += "# HELP " + told + " ";
    // Only OpenMetrics has quotes escaped here.
    for (const char c : family.help) {
      if (c == '"' && format == MetricFormat::kOpenMetrics) text += '\\';
      text += c;
    }
    text += "\n# TYPE " + told + " " + std::string(type_name_in(format, family.type)) + "\n";
    if (!family.unit.empty()) text += "# UNIT " + told + " " + std::string(family.unit) + "\n";
    for (const auto& [labels, lines] : found->second) {
      for (const auto& [head, value] : lines) {
        text += name;
        text += head + " " + value + "\n";
      }
    }
  }
  return text + "# EOF\n";
}

}  // namespace strata::live_view
