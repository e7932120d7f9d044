// SPDX-License-Identifier: Apache-2.0
/// One feature of a zones file: for zones.cpp alone.
#pragma once

#include <cstddef>
#include <string>

#include "components/site/zones.hpp"

namespace strata::site {

/// "PLACE: feature N: ", from 1 on.
[[nodiscard]] std::string feature_place(const std::string& place, std::size_t index);

/// corners: of all features so far; the feature's own are added. Throws InputError.
[[nodiscard]] Zone read_feature(const Zones::Document& feature, std::size_t index,
                                const std::string& place, std::size_t& corners);

}  // namespace strata::site
