// SPDX-License-Identifier: Apache-2.0
/// A textured mesh as a file that 3-D programs and browsers open.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/report/volume_picture.hpp"
#include "tools/textures/textured_mesh.hpp"

namespace strata::textures {

/// Binary glTF 2.0 with the texture as PNG inside; z is up in the map frame, y in the file. Faces
/// are seen from both sides and not shaded. Throws OutputError.
[[nodiscard]] std::string glb_of(const TexturedMesh& mesh);

/// A cube a texel of the polygons below `ceiling_m`, for report::draw_cubes; where the mesh has
/// more texels than max_cubes (at least 1), one a square of several, in the colour of its middle.
[[nodiscard]] std::vector<report::ColoredCube> texel_cubes(const TexturedMesh& mesh,
                                                           double ceiling_m,
                                                           std::size_t max_cubes = 4'000'000);

}  // namespace strata::textures
