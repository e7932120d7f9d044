// SPDX-License-Identifier: Apache-2.0
/// The page of the map models, from their descriptors.
#pragma once

#include <string>

#include "components/maps/map_models.hpp"

namespace strata::reference {

/// Markdown: a row a model.
[[nodiscard]] std::string map_models_page(const maps::MapModels& models);

}  // namespace strata::reference
