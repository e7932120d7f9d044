// SPDX-License-Identifier: Apache-2.0
/// Pictures beside results: one that cannot be drawn costs no result.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace strata::report {

class Drawings {
 public:
  /// Runs `draw`, which writes the file (or a folder of pictures). When that fails, what there is
  /// of it is removed, and the reason kept. Throws Cancelled.
  void add(const std::filesystem::path& file, const std::function<void()>& draw);
  /// What is missing and, of the first, why; empty when nothing is.
  [[nodiscard]] std::string what_is_missing() const;

 private:
  std::vector<std::string> missing_;
  std::string reason_;  ///< of the first: what, and what to do
};

/// drawings.add, or, where there are none, `draw` alone, which may throw.
void draw(Drawings* drawings, const std::filesystem::path& file, const std::function<void()>& draw);

}  // namespace strata::report
