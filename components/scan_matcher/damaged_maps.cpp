// SPDX-License-Identifier: Apache-2.0
#include "components/scan_matcher/damaged_maps.hpp"

#include <string>
#include <system_error>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"

namespace fs = std::filesystem;

namespace strata::scan_matcher {

std::optional<DamageError> damage_of_live_maps(const fs::path& folder) {
  const char* const remedy = "put the folder back from a backup while the component is stopped";
  const fs::path store = folder / maps::kStoreFile;
  const fs::path summary = folder / maps::kSummaryFile;
  std::error_code error;
  if (!fs::is_regular_file(summary, error)) return std::nullopt;
  const std::string log = maps::log_of(folder);
  const bool has_store = fs::exists(store, error);
  if (log == kLiveLog && !has_store) return DamageError(store.string(), "is gone", remedy);
  const bool may_be_live = log.empty() || log == kLiveLog;
  if (may_be_live && has_store && fs::file_size(store, error) == 0) {
    return DamageError(store.string(), "is empty", remedy);
  }
  if (log.empty() && has_store) return DamageError(summary.string(), "cannot be read", remedy);
  return std::nullopt;
}

}  // namespace strata::scan_matcher
