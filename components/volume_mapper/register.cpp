// SPDX-License-Identifier: Apache-2.0
#include "components/volume_mapper/register.hpp"

#include "components/volume_mapper/volume_mapper.hpp"

namespace strata::volume_mapper {

void register_component(runtime::Registry& registry) {
  registry.add<VolumeMapper>("strata::VolumeMapper");
}

}  // namespace strata::volume_mapper
