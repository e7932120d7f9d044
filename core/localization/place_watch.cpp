// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_watch.hpp"

#include <algorithm>

namespace strata::localization {
namespace {

/// Searches in vain become rare, but do not end.
constexpr int kMaxRest = 1000;

}  // namespace

void PlaceWatch::believe() {
  forget();
  was_believed_ = true;
}

PlaceWatch::Step PlaceWatch::judge(double score) {
  if (!config_.is_used) return Step::kNone;
  if (score >= config_.trusted_score) {
    const bool ends = is_searching_;
    believe();
    return ends ? Step::kEnd : Step::kNone;
  }
  if (is_searching_) {
    if (++searched_ < config_.max_scans) return Step::kNone;
    rest_ = std::max(config_.max_scans, std::min(2 * rest_, kMaxRest));
    doubted_ = -rest_;
    is_searching_ = false;
    return Step::kEnd;
  }
  if (doubted_ < 0) {
    ++doubted_;
    return Step::kNone;
  }
  was_believed_ |= score >= config_.doubted_score;
  doubted_ = score < config_.doubted_score ? doubted_ + 1 : 0;
  if (doubted_ < config_.doubted_scans) return Step::kNone;
  is_searching_ = true;
  doubted_ = searched_ = 0;
  return Step::kBegin;
}

}  // namespace strata::localization
