// SPDX-License-Identifier: Apache-2.0
/// Changed places as JSON, for the topic and for files.
#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include "memory/nodes/changed_places.hpp"

namespace strata::maps {

/// [{"kind": "appeared" | "vanished", "center": [x, y], "min", "max", "cells"}], metres in the map
/// frame, in the given order.
[[nodiscard]] nlohmann::ordered_json to_json(std::span<const memory::ChangedPlace> places);

}  // namespace strata::maps
