// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/particle_clouds.hpp"

#include <cstddef>

#include "components/convert/geometry_messages.hpp"

namespace strata::tools {

localization::ParticleSet from_message(const nav2_msgs::msg::ParticleCloud& cloud) {
  localization::ParticleSet particles;
  particles.resize(cloud.particles().size());
  for (std::size_t i = 0; i < cloud.particles().size(); ++i) {
    particles.set_pose(i, planar(convert::from_message(cloud.particles()[i].pose())));
    particles.weight[i] = cloud.particles()[i].weight();
  }
  return particles;
}

pipeline::ScanError error_of(const nav2_msgs::msg::ParticleCloud& cloud, const Pose2& truth) {
  const localization::ParticleSet particles = from_message(cloud);
  return {convert::from_message(cloud.header().stamp()),
          localization::weighted_error(particles, truth),
          localization::weighted_heading_error(particles, truth)};
}

}  // namespace strata::tools
