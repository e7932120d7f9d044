// SPDX-License-Identifier: Apache-2.0
#include "components/site/active_maps.hpp"

#include <system_error>

#include "components/log/content_hash.hpp"
#include "components/site/map_version.hpp"
#include "components/site/site.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {

fs::path real_maps(const fs::path& maps) {
  std::error_code error;
  const bool is_site = fs::exists(maps / kSiteFile, error);
  const fs::path named = is_site ? maps / kActiveLink : maps;
  fs::path real = fs::canonical(named, error);
  if (!error) return real;
  if (is_site && !levels_of(maps).empty()) {
    throw InputError(maps.string(), "has levels, each with its own maps",
                     "name one, such as " + levels_of(maps).front().folder.string());
  }
  if (is_site) {
    throw InputError(maps.string(), "has no active version that is there",
                     "`strata site status` says what there is, `strata site activate` takes one");
  }
  throw InputError(maps.string(), "cannot be reached: " + error.message(),
                   "give a folder that `strata learn` wrote, or a site");
}

fs::path maps_or_active(const fs::path& maps) {
  std::error_code error;
  return fs::exists(maps / kSiteFile, error) ? real_maps(maps) : maps;
}

bool is_version(const fs::path& real) {
  std::error_code error;
  return fs::exists(real.parent_path() / kVersionFile, error);
}

MapIdentity identify(const fs::path& real) {
  const log::HashedContent content = log::hash_content(real);
  if (!is_version(real)) return {real.filename().string(), "", content.hash};
  const MapVersion version = read_version(real.parent_path() / kVersionFile);
  if (version.hash != content.hash) {
    throw InputError(real.string(), "is damaged: its hash does not hold",
                     "`strata site rollback` gives back the version before");
  }
  return {version.site, std::to_string(version.number), version.hash};
}

}  // namespace strata::site
