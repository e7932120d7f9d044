// SPDX-License-Identifier: Apache-2.0
/// Whether a localizer knew where the robot was, at a moment of a while ago.
#pragma once

#include <deque>
#include <optional>

#include "core/base/time.hpp"

namespace strata::volume_mapper {

/// What it says after each scan. Between two scans it is localized when it is at both.
class ToldHealth {
 public:
  /// keep_s: what is older than this behind the newest is forgotten.
  explicit ToldHealth(double keep_s = 10.0) : keep_s_(keep_s) {}

  /// In order of arrival: what was told of later moments is of a clock that has been set back
  /// since.
  void add(Stamp stamp, bool is_localized);
  [[nodiscard]] bool is_empty() const { return told_.empty(); }
  /// Of the whole time between the two; nothing while nothing has been told of its end.
  [[nodiscard]] std::optional<bool> is_localized(Stamp begin, Stamp end) const;

 private:
  struct Told {
    Stamp stamp;
    bool is_localized = false;
  };
  double keep_s_;
  std::deque<Told> told_;  ///< by stamp
};

}  // namespace strata::volume_mapper
