// SPDX-License-Identifier: Apache-2.0
/// The pictures of map_server maps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "components/log/map_file.hpp"

namespace strata::log {

/// Grey, top row first.
struct MapImage {
  int width = 0;
  int height = 0;
  int white = 255;
  std::vector<std::uint8_t> pixels;  ///< a colour is the mean of its channels
  std::vector<std::uint8_t> alpha;   ///< 255: opaque; empty: everything is
};

/// PGM (P5 or P2), PNG or BMP, told by content. yaml: who names it, for errors. Throws InputError.
[[nodiscard]] MapImage read_map_image(const std::filesystem::path& path, const std::string& yaml);

/// Written aside and renamed. A PGM loses alpha. Throws OutputError.
void write_map_image(const std::filesystem::path& path, const MapImage& image,
                     MapImageFormat format);

}  // namespace strata::log
