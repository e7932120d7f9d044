// SPDX-License-Identifier: Apache-2.0
/// Recorded messages taken apart by the text of their type, for comparisons; the first byte chooses
/// the type. The corpus names types by their place below: new ones go to the end.
#include <array>

#include "components/log/message_fields.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

constexpr std::array kTypes = {
    "sensor_msgs/msg/LaserScan",
    "nav_msgs/msg/Odometry",
    "tf2_msgs/msg/TFMessage",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "nav_msgs/msg/OccupancyGrid",
    "strata_msgs/msg/LabeledScan",
    "strata_msgs/msg/PatchMap",
    "strata_msgs/msg/NodeMap",
    "strata_msgs/msg/Topologies",
    "sensor_msgs/msg/PointCloud2",
    "octomap_msgs/msg/Octomap",
    "diagnostic_msgs/msg/DiagnosticArray",
    "rcl_interfaces/msg/ParameterEvent",
    "rmw_dds_common/msg/ParticipantEntitiesInfo",
    "std_msgs/msg/Unheard",
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  if (size == 0) return 0;
  return fuzz::expect_value_or_error([&] {
    const std::string type = kTypes[data[0] % kTypes.size()];
    const fuzz::Input cdr(data + 1, size - 1);
    const auto fields = log::message_fields(type, cdr);
    if (!fields) return;
    // Each value has a name, and nothing else has.
    const std::size_t count = fields->size();
    if (!log::field_path(type, cdr, count).empty()) __builtin_trap();
    for (const std::size_t index : {std::size_t{0}, count / 2, count - 1}) {
      if (index < count && log::field_path(type, cdr, index).empty()) __builtin_trap();
    }
  });
}
