// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/test_part.hpp"

#include <array>
#include <utility>

#include "core/base/error.hpp"

namespace strata::pipeline {

std::vector<TestPart> make_test_parts(const Runs& runs, const Split& split,
                                      const std::vector<double>& elapsed,
                                      const std::vector<std::optional<Pose2>>& truths,
                                      const CompareProtocol& protocol) {
  std::vector<TestPart> parts;
  bool is_open = false;
  int run = -1;
  for (const std::size_t i : split.test) {
    if (runs.observations[i].run != run) is_open = false;
    run = runs.observations[i].run;
    if (!is_open && !truths[i]) continue;
    if (!is_open) {
      TestPart part;
      part.info.train_s = {elapsed[split.train.front()], elapsed[split.train.back()]};
      part.info.test_s = {elapsed[i], elapsed[i]};
      part.start.mean = *truths[i];
      const double m = protocol.start_stddev_m;
      const double rad = protocol.start_stddev_rad;
      part.start.covariance = Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal();
      parts.push_back(std::move(part));
      is_open = true;
    }
    TestPart& part = parts.back();
    part.info.test_s[1] = elapsed[i];
    part.observations.push_back(runs.observations[i]);
    part.truths.push_back(truths[i]);
  }
  if (parts.empty()) {
    throw InputError("test part", "has no scan with a known pose",
                     "choose another split with --train-until");
  }
  for (TestPart& part : parts) {
    part.info.name = split.name;
    if (parts.size() > 1) {
      part.info.name += ", run " + std::to_string(part.observations.front().run + 1);
    }
    part.info.scans = part.observations.size();
  }
  return parts;
}

void look_for_changes(std::span<const PosedScan> learned, const ReflectionGrid& map,
                      const CompareConfig& config, TestPart& part) {
  part.changes = find_changes(learned, part.observations, part.truths, map, config.learn.patch,
                              config.sensor.beam.beams.max_range_m);
  const Stamp begin = part.observations.front().scan.stamp;
  for (const ChangeEvent& event : part.changes.events) {
    const Stamp first_seen = part.observations[event.views.front().scan].scan.stamp;
    part.info.changes.push_back({(first_seen - begin).seconds(), event.center_m, event.views.size(),
                                 event.is_old_state, event.appeared_share});
  }
  for (std::size_t i = 0; i < part.observations.size(); ++i) {
    if (!part.truths[i]) continue;
    part.info.changed_scans += part.changes.sees_change(i) ? 1 : 0;
    part.info.unmapped_scans +=
        is_known(map.get(map.cell_at(part.truths[i]->translation()))) ? 0 : 1;
  }
}

namespace {

/// Mean errors over the scans that show a state that came back, and one never seen before.
void judge_states(const TestPart& part, ModelRun& run) {
  std::vector<std::uint8_t> shows(part.observations.size(), 0);
  for (const ChangeEvent& event : part.changes.events) {
    for (const ChangeView& view : event.views) shows[view.scan] |= event.is_old_state ? 1 : 2;
  }
  std::array<double, 2> sums{};
  std::array<double, 2> counts{};
  std::size_t e = 0;
  for (std::size_t i = 0; i < part.observations.size(); ++i) {
    if (!part.truths[i]) continue;
    const double error_m = run.errors[e++].error_m;
    for (std::size_t kind = 0; kind < 2; ++kind) {
      if ((shows[i] >> kind & 1) == 0) continue;
      sums[kind] += error_m;
      counts[kind] += 1.0;
    }
  }
  if (counts[0] > 0.0) run.old_state_error_m = sums[0] / counts[0];
  if (counts[1] > 0.0) run.new_state_error_m = sums[1] / counts[1];
}

}  // namespace

void judge_changed_places(const TestPart& part, ModelRun& run) {
  double sum = 0.0;
  std::size_t failures = 0;
  std::size_t count = 0;
  std::size_t e = 0;
  for (std::size_t i = 0; i < part.observations.size(); ++i) {
    if (!part.truths[i]) continue;
    const double error_m = run.errors[e++].error_m;
    run.sees_change.push_back(part.changes.sees_change(i) ? 1 : 0);
    if (run.sees_change.back() == 0) continue;
    ++count;
    sum += error_m;
    failures += error_m > kFailureDistance_m ? 1 : 0;
  }
  judge_states(part, run);
  if (count == 0) return;
  run.changed_error_m = sum / static_cast<double>(count);
  run.changed_failure_rate = static_cast<double>(failures) / static_cast<double>(count);
}

}  // namespace strata::pipeline
