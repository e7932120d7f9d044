// SPDX-License-Identifier: Apache-2.0
/// The services that rosbag2's player and recorder have; apart from message_types.hpp, since only
/// ours need them.
#pragma once

#include "strata_idl/rosbag2_interfaces.h"

#include "components/bus/message_types.hpp"

namespace strata::bus {

#define STRATA_BAG_SERVICE_TYPE(type)                                    \
  namespace srv {                                                        \
  struct type;                                                           \
  }                                                                      \
  template <>                                                            \
  struct ServiceType<srv::type> {                                        \
    static constexpr const char* name = "rosbag2_interfaces/srv/" #type; \
    using Request = rosbag2_interfaces::srv::type##_Request;             \
    using Response = rosbag2_interfaces::srv::type##_Response;           \
  }

STRATA_BAG_SERVICE_TYPE(Pause);
STRATA_BAG_SERVICE_TYPE(Resume);
STRATA_BAG_SERVICE_TYPE(TogglePaused);
STRATA_BAG_SERVICE_TYPE(IsPaused);
STRATA_BAG_SERVICE_TYPE(GetRate);
STRATA_BAG_SERVICE_TYPE(SetRate);
STRATA_BAG_SERVICE_TYPE(PlayNext);
STRATA_BAG_SERVICE_TYPE(Seek);
STRATA_BAG_SERVICE_TYPE(SplitBagfile);

#undef STRATA_BAG_SERVICE_TYPE

}  // namespace strata::bus
