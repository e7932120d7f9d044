// SPDX-License-Identifier: Apache-2.0
/// A comparison as bytes and back (core/base/state_archive.hpp).
#pragma once

#include <concepts>
#include <type_traits>

#include "core/base/state_archive.hpp"
#include "core/geometry/matrix_state.hpp"
#include "tools/pipeline/comparison.hpp"

namespace strata::pipeline {

/// For StateReader.
[[nodiscard]] constexpr TruthKind last_enumerator(TruthKind /*of*/) {
  return TruthKind::kJointTrajectory;
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, ModelRun>
void state_of(Value& run, Archive& archive) {
  archive(run.part);
  archive(run.seed);
  archive(run.errors);
  archive(run.sees_change);
  archive(run.estimates);
  archive(run.update_ms);
  archive(run.metrics);
  archive(run.changed_error_m);
  archive(run.changed_failure_rate);
  archive(run.old_state_error_m);
  archive(run.new_state_error_m);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, PredictionScore>
void state_of(Value& score, Archive& archive) {
  archive(score.overall);
  archive(score.changed);
  archive(score.events);
  archive(score.series);
  archive(score.query_ms);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, StateTrace>
void state_of(Value& trace, Archive& archive) {
  archive(trace.submap);
  archive(trace.time_s);
  archive(trace.probability);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, MemoryPoint>
void state_of(Value& point, Archive& archive) {
  archive(point.setting);
  archive(point.bytes);
  archive(point.run_means_m);
  archive(point.lost_runs);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, ModelResult>
void state_of(Value& model, Archive& archive) {
  archive(model.model);
  archive(model.map_bytes);
  archive(model.resident_bytes);
  archive(model.scores);
  archive(model.runs);
  archive(model.states);
  archive(model.memory);
  archive(model.false_adaptation);
  archive(model.planning);
  archive(model.own_pose);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, MetChange>
void state_of(Value& change, Archive& archive) {
  archive(change.time_s);
  archive(change.center_m);
  archive(change.scans);
  archive(change.is_old_state);
  archive(change.appeared_share);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, TestPartInfo>
void state_of(Value& part, Archive& archive) {
  archive(part.name);
  archive(part.train_s);
  archive(part.test_s);
  archive(part.scans);
  archive(part.changed_scans);
  archive(part.unmapped_scans);
  archive(part.changes);
}

template <typename Value, typename Archive>
requires std::same_as<std::remove_const_t<Value>, Comparison>
void state_of(Value& comparison, Archive& archive) {
  archive(comparison.log);
  archive(comparison.via);
  archive(comparison.seeds);
  archive(comparison.truth);
  archive(comparison.parts);
  archive(comparison.models);
}

}  // namespace strata::pipeline
