// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/live_odometry.hpp"

#include <utility>

namespace strata::runtime {
namespace {

constexpr double kTrackKeptS = 30.0;

}  // namespace

void LiveOdometry::begin_anew() {
  track_.clear();
  watch_ = {};
  suspect_.reset();
}

void LiveOdometry::add(const log::OdometrySample& sample, bool at_once,
                       const std::function<void(Stamp)>& set_back) {
  using Verdict = log::SetBackWatch::Verdict;
  const Verdict verdict = watch_.add(sample.stamp);
  const std::optional<log::OdometrySample> suspect = std::exchange(suspect_, std::nullopt);
  const bool is_set_back = verdict == Verdict::kSetBack || (at_once && verdict != Verdict::kOn);
  if (is_set_back) {
    set_back(suspect ? suspect->stamp : sample.stamp);
    track_.clear();
  }
  if (at_once && is_set_back) {
    watch_ = {};
    (void)watch_.add(sample.stamp);
  } else if (verdict == Verdict::kSuspect) {
    suspect_ = sample;
  }
  if (suspect) track_.add(*suspect);
  if (!suspect_) track_.add(sample);
  track_.forget(kTrackKeptS);
}

}  // namespace strata::runtime
