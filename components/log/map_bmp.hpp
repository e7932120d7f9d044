// SPDX-License-Identifier: Apache-2.0
/// Maps of map_server drawn as Windows bitmaps.
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <string>

#include "components/log/map_image.hpp"
#include "core/base/error.hpp"

namespace strata::log {

/// A BMP without compression: 1, 4 or 8 bits a pixel with a palette, 24 or 32 bits; rows from
/// either end; opacity where a V4 or V5 header names its byte. in: from its first byte on;
/// file_size: in bytes. Takes no more memory than a few bytes for each bit that is there. Throws
/// what `refuse` makes of the reason. O(pixels). Source: Microsoft's BITMAPFILEHEADER,
/// BITMAPINFOHEADER, BITMAPV4HEADER and BITMAPV5HEADER.
[[nodiscard]] MapImage read_bmp(std::istream& in, std::uintmax_t file_size,
                                const std::function<InputError(const std::string&)>& refuse);

}  // namespace strata::log
