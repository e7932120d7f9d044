// SPDX-License-Identifier: Apache-2.0
/// What tells of a site's versions and decides on them; apart from message_types.hpp, since only
/// those who own a site or ask for it need them.
#pragma once

#include "strata_idl/strata_msgs_site.h"

#include "components/bus/message_types.hpp"

namespace strata::bus {

template <>
struct MessageType<strata_msgs::msg::SiteVersions> {
  static constexpr const char* name = "strata_msgs/msg/SiteVersions";
};

template <>
struct MessageType<strata_msgs::msg::SiteLevel> {
  static constexpr const char* name = "strata_msgs/msg/SiteLevel";
};

#define STRATA_SITE_SERVICE_TYPE(type)                            \
  namespace srv {                                                 \
  struct type;                                                    \
  }                                                               \
  template <>                                                     \
  struct ServiceType<srv::type> {                                 \
    static constexpr const char* name = "strata_msgs/srv/" #type; \
    using Request = strata_msgs::srv::type##_Request;             \
    using Response = strata_msgs::srv::type##_Response;           \
  }

STRATA_SITE_SERVICE_TYPE(ListSiteVersions);
STRATA_SITE_SERVICE_TYPE(ApproveSiteVersion);
STRATA_SITE_SERVICE_TYPE(ActivateSiteVersion);
STRATA_SITE_SERVICE_TYPE(RollBackSite);
STRATA_SITE_SERVICE_TYPE(GetSiteVersionMap);
STRATA_SITE_SERVICE_TYPE(SetSiteLevel);

#undef STRATA_SITE_SERVICE_TYPE

}  // namespace strata::bus
