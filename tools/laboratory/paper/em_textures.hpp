// SPDX-License-Identifier: Apache-2.0
/// Figure 1.10 of [stachniss2003chapter]: rooms as textured polygons, with and without filtering.
#pragma once

#include "tools/laboratory/paper/figure.hpp"

namespace strata::paper {

[[nodiscard]] Outcome textured_rooms(const Setting& setting);

}  // namespace strata::paper
