// SPDX-License-Identifier: Apache-2.0
/// What each component keeps for its next start, written as a life of it would have.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "components/runtime/registry.hpp"

namespace strata::test {

struct KeptFile {
  std::string component;  ///< without "strata::"
  std::string name;       ///< of the file
  std::function<void(const std::filesystem::path&)> write;
  /// The parameter that names it, YAML; "%" is the file.
  std::string parameter;
  /// Another setting with which the same file is of no use but whole; empty: there is none.
  std::string other_settings;

  [[nodiscard]] std::string entry(const std::filesystem::path& file,
                                  const std::string& more = "") const;
};

inline std::ostream& operator<<(std::ostream& out, const KeptFile& kept) {
  return out << kept.component;
}

[[nodiscard]] const std::vector<KeptFile>& kept_files();

/// Of all these components.
[[nodiscard]] runtime::Registry keepers();

}  // namespace strata::test
