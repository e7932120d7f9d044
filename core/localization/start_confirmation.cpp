// SPDX-License-Identifier: Apache-2.0
#include "core/localization/start_confirmation.hpp"

#include <algorithm>

namespace strata::localization {
namespace {

/// Searches in vain become rare, but do not end.
constexpr int kMaxPatience = 1000;

}  // namespace

void StartConfirmation::search() {
  if (!is_pending_) patience_ = config_.search_again_scans;
  is_pending_ = true;
  scans_ = 0;
}

bool StartConfirmation::judge(double score) {
  if (!is_pending_) return false;
  if (score >= config_.confirmed_score) {
    is_pending_ = false;
    scans_ = 0;
    return false;
  }
  // A score that rises is left to rise: a search would begin its doubt anew.
  if (++scans_ < patience_ || score >= config_.refuted_score) return false;
  patience_ = std::min(2 * patience_, kMaxPatience);
  return true;
}

}  // namespace strata::localization
