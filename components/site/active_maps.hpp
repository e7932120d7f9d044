// SPDX-License-Identifier: Apache-2.0
/// Which maps a name leads to now, for programs that use them.
#pragma once

#include <filesystem>
#include <string>

namespace strata::site {

/// What VDA 5050 calls mapId, mapVersion and mapHash.
struct MapIdentity {
  std::string id;       ///< of the site; of maps of no site, the folder's name
  std::string version;  ///< a version's number; of maps of no site empty
  std::string hash;     ///< of the content, 64 digits
};

/// The MAPS folder that `maps` leads to, without links: of a site (its folder) the active version;
/// else the folder itself. Cheap: it reads links. Throws InputError where a site has no active
/// version, or a link leads to nothing.
[[nodiscard]] std::filesystem::path real_maps(const std::filesystem::path& maps);

/// `maps` itself, or what real_maps() says where it is a site. Throws InputError as that does.
[[nodiscard]] std::filesystem::path maps_or_active(const std::filesystem::path& maps);

/// Whether a folder that real_maps() gave is a version of a site.
[[nodiscard]] bool is_version(const std::filesystem::path& real);

/// Who the maps in a folder that real_maps() gave are. Reads all of them. Throws InputError where
/// they are a site's version and its hash does not hold, or where they cannot be read.
[[nodiscard]] MapIdentity identify(const std::filesystem::path& real);

}  // namespace strata::site
