// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/metrics_page.hpp"

#include "components/live_view/metric_families.hpp"

namespace strata::reference {
namespace {

/// As Prometheus keeps it.
std::string shown_name(const live_view::MetricFamily& family) {
  return std::string(family.name) + std::string(live_view::suffix_of(family.type));
}

}  // namespace

std::string metrics_page() {
  std::string text =
      "# Metrics\n\nWhat `/metrics` of the live view answers ([dashboards](../dashboards.md)). "
      "Each has the label `component`, the full name, but for those that begin with `process_`. "
      "A metric is there when a component says it.\n\nMade by `strata-reference` from the code; "
      "do not edit.\n\n| metric | type | labels | key on `/diagnostics` | what it is |\n"
      "|---|---|---|---|---|\n";
  for (const live_view::MetricFamily& family : live_view::metric_families()) {
    std::string keys;
    for (const live_view::StatusFigure& figure : live_view::status_figures()) {
      if (figure.family != family.name) continue;
      keys += (keys.empty() ? "`" : ", `") + std::string(figure.key);
      keys += figure.key.ends_with(' ') ? "TOPIC`" : "`";
      if (!figure.value.empty()) keys += " (" + std::string(figure.value) + ")";
    }
    text += "| `" + shown_name(family) + "` | " + std::string(live_view::type_name(family.type)) +
            " | " + std::string(family.labels) + " | " + keys + " | " + std::string(family.help) +
            " |\n";
  }
  return text;
}

}  // namespace strata::reference
