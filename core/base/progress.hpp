// SPDX-License-Identifier: Apache-2.0
/// How long work reports how far it is, and learns that the user wants it to stop.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace strata {

/// Implemented by whoever shows progress (a terminal, a topic). Algorithms take a pointer that may
/// be null, call `update` every so often, and throw `Cancelled` when `cancelled()` says so.
/// Called from the thread that runs the algorithm.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  virtual ~Progress() = default;

  /// stage: a few words, lower case ("match scans"); done of total steps of this stage.
  virtual void update(std::string_view stage, std::size_t done, std::size_t total) = 0;
  [[nodiscard]] virtual bool cancelled() const { return false; }
};

/// Reports to `progress` when there is one; throws Cancelled when the user asked to stop.
inline void report_progress(Progress* progress, std::string_view stage, std::size_t done,
                            std::size_t total) {
  if (progress == nullptr) return;
  if (progress->cancelled()) throw Cancelled(std::string(stage));
  progress->update(stage, done, total);
}

}  // namespace strata
