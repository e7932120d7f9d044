// SPDX-License-Identifier: Apache-2.0
/// Messages that come over the wire or out of bags; the first byte chooses the type.
#include "strata_idl/nav_msgs.h"
#include "strata_idl/rmw_dds_common.h"
#include "strata_idl/rmw_dds_common_24.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/tf2_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using strata::convert::from_cdr;
using strata::convert::from_message;

/// Also turns the message into what the core works on.
template <typename Message>
void receive(strata::fuzz::Input bytes) {
  const auto message = from_cdr<Message>(bytes, "fuzz");
  if constexpr (requires { from_message(message); }) (void)from_message(message);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const strata::fuzz::Input bytes(data + 1, size - 1);
  return strata::fuzz::expect_value_or_error([&] {
    switch (data[0] % 11) {
      case 0:
        return (void)from_message(from_cdr<sensor_msgs::msg::LaserScan>(bytes, "fuzz"),
                                  strata::Pose2{});
      case 1:
        return receive<nav_msgs::msg::Odometry>(bytes);
      case 2:
        return receive<tf2_msgs::msg::TFMessage>(bytes);
      case 3:
        return receive<geometry_msgs::msg::PoseWithCovarianceStamped>(bytes);
      case 4:
        return receive<nav_msgs::msg::OccupancyGrid>(bytes);
      case 5:
        return receive<strata_msgs::msg::LabeledScan>(bytes);
      case 6:
        return receive<strata_msgs::msg::ReflectionGrid>(bytes);
      case 7:
        return receive<strata_msgs::msg::PatchMap>(bytes);
      case 8:
        return receive<strata_msgs::msg::Step>(bytes);
      case 9:
        return receive<strata_msgs::msg::Ack>(bytes);
      default:
        return receive<rmw_dds_common::msg::ParticipantEntitiesInfo>(bytes);
    }
  });
}
