// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace strata::convert {

/// The files of idl/, built into the library by CMakeLists.txt.
[[nodiscard]] std::span<const std::string_view> idl_texts();

}  // namespace strata::convert
