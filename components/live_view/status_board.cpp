// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/status_board.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include <sys/resource.h>

#include "components/log/text.hpp"
#include "components/runtime/diagnostics.hpp"
#include "components/runtime/free_memory.hpp"
#include "core/localization/recovery.hpp"

namespace strata::live_view {
namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using runtime::value_of;

constexpr std::string_view kOurs = "strata";
constexpr std::string_view kEnding = ": health";

bool goes_on_with_topic(FigureKind kind) {
  return kind == FigureKind::kTopicNumber || kind == FigureKind::kTopicTimes;
}

/// The figure that the key is of, and the topic that it goes on with.
const StatusFigure* find_figure(std::string_view key, std::string_view& topic) {
  for (const StatusFigure& figure : status_figures()) {
    if (!goes_on_with_topic(figure.kind)) {
      if (key == figure.key) return &figure;
    } else if (key.starts_with(figure.key) && key.substr(figure.key.size()).starts_with('/')) {
      topic = key.substr(figure.key.size());
      return &figure;
    }
  }
  return nullptr;
}

void write_entry(const std::string& key, const std::string& value, MetricLabels labels,
                 MetricText& metrics) {
  std::string_view topic;
  const StatusFigure* figure = find_figure(key, topic);
  if (figure == nullptr) return;
  if (!topic.empty()) labels.emplace_back("topic", topic);
  if (!figure->label.empty()) labels.emplace_back(figure->label, figure->value);
  switch (figure->kind) {
    case FigureKind::kTruth:
      return metrics.add(figure->family, labels, value == "true" ? 1.0 : 0.0);
    case FigureKind::kTimes:
    case FigureKind::kTopicTimes: {
      HistogramCounts counts;
      if (read_histogram(value, counts)) metrics.add(figure->family, labels, counts);
      return;
    }
    case FigureKind::kNumber:
    case FigureKind::kTopicNumber:
      if (const auto number = log::parse_double(value)) {
        metrics.add(figure->family, labels, *number * figure->scale);
      }
      return;
  }
}

void write_words(const DiagnosticStatus& status, const MetricLabels& labels, MetricText& metrics) {
  metrics.add("strata_component_level", labels, status.level());
  metrics.add("strata_component_active", labels, value_of(status, "state") == "active" ? 1.0 : 0.0);
  const std::string_view verdict = value_of(status, "verdict");
  for (const auto& [state, name] : EnumNames<localization::HealthState>::values) {
    if (verdict.empty()) break;
    MetricLabels with_verdict = labels;
    with_verdict.emplace_back("verdict", name);
    metrics.add("strata_localization_verdict", with_verdict, verdict == name ? 1.0 : 0.0);
  }
  const std::string_view model = value_of(status, "model");
  const std::string_view maps = value_of(status, "maps");
  if (model.empty() || maps.empty()) return;
  MetricLabels with_map = labels;
  with_map.emplace_back("model", model);
  with_map.emplace_back("maps", maps);
  with_map.emplace_back("sha256", value_of(status, "mapHash"));
  metrics.add("strata_localization_map", with_map, 1.0);
}

}  // namespace

void StatusBoard::take(const diagnostic_msgs::msg::DiagnosticArray& array, Clock::time_point now) {
  for (const DiagnosticStatus& status : array.status()) {
    const std::string_view name = status.name();
    if (status.hardware_id() != kOurs || !name.ends_with(kEnding)) continue;
    const std::string component = "/" + std::string(name.substr(0, name.size() - kEnding.size()));
    Heard heard{std::make_shared<const DiagnosticStatus>(status), now};
    const std::lock_guard lock(mutex_);
    std::erase_if(components_,
                  [&](const auto& entry) { return now - entry.second.at > kForgotten; });
    if (components_.size() >= kMaxComponents && !components_.contains(component)) continue;
    std::swap(components_[component], heard);  // the one of before goes when the lock has gone
  }
}

void StatusBoard::write(MetricText& metrics, Clock::time_point now) const {
  const auto components = [this] {
    const std::lock_guard lock(mutex_);
    return components_;
  }();
  for (const auto& [name, heard] : components) {
    const MetricLabels labels{{"component", name}};
    if (now - heard.at > kForgotten) continue;
    const bool is_up = now - heard.at <= kSilent;
    metrics.add("strata_component_up", labels, is_up ? 1.0 : 0.0);
    if (!is_up) continue;
    write_words(*heard.status, labels, metrics);
    const auto& values = heard.status->values();
    for (std::size_t i = 0; i < std::min(values.size(), kMaxEntries); ++i) {
      write_entry(values[i].key(), values[i].value(), labels, metrics);
    }
  }
}

void write_process(MetricText& metrics) {
  if (const std::size_t bytes = runtime::resident_bytes(); bytes > 0) {
    metrics.add("process_resident_memory_bytes", {}, static_cast<double>(bytes));
  }
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) {
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    metrics.add("process_cpu_seconds", {}, seconds(usage.ru_utime) + seconds(usage.ru_stime));
  }
  std::error_code error;
  std::size_t open = 0;
  for (std::filesystem::directory_iterator at("/proc/self/fd", error), end; !error && at != end;
       at.increment(error)) {
    ++open;
  }
  if (open > 0) metrics.add("process_open_fds", {}, static_cast<double>(open));
}

}  // namespace strata::live_view
