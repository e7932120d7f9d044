// SPDX-License-Identifier: Apache-2.0
/// The ROS 2 name of each message and service type that generated code brings.
#pragma once

#include "strata_idl/bond.h"
#include "strata_idl/diagnostic_msgs.h"
#include "strata_idl/geometry_msgs.h"
#include "strata_idl/lifecycle_msgs.h"
#include "strata_idl/nav2_msgs.h"
#include "strata_idl/nav_msgs.h"
#include "strata_idl/octomap_msgs.h"
#include "strata_idl/rcl_interfaces.h"
#include "strata_idl/rosgraph_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/std_msgs.h"
#include "strata_idl/std_srvs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/tf2_msgs.h"
#include "strata_idl/type_description_interfaces.h"

namespace strata::bus {

/// MessageType<T>::name is "package/msg/Name".
template <typename T>
struct MessageType;

#define STRATA_MESSAGE_TYPE(package, type)                      \
  template <>                                                   \
  struct MessageType<package::msg::type> {                      \
    static constexpr const char* name = #package "/msg/" #type; \
  }

STRATA_MESSAGE_TYPE(bond, Status);
STRATA_MESSAGE_TYPE(diagnostic_msgs, DiagnosticArray);
STRATA_MESSAGE_TYPE(geometry_msgs, PointStamped);
STRATA_MESSAGE_TYPE(geometry_msgs, PoseWithCovarianceStamped);
STRATA_MESSAGE_TYPE(lifecycle_msgs, TransitionEvent);
STRATA_MESSAGE_TYPE(nav2_msgs, CostmapFilterInfo);
STRATA_MESSAGE_TYPE(nav2_msgs, ParticleCloud);
STRATA_MESSAGE_TYPE(nav_msgs, OccupancyGrid);
STRATA_MESSAGE_TYPE(nav_msgs, Odometry);
STRATA_MESSAGE_TYPE(nav_msgs, Path);
STRATA_MESSAGE_TYPE(octomap_msgs, Octomap);
STRATA_MESSAGE_TYPE(rcl_interfaces, Log);
STRATA_MESSAGE_TYPE(rcl_interfaces, ParameterEvent);
STRATA_MESSAGE_TYPE(rosgraph_msgs, Clock);
STRATA_MESSAGE_TYPE(sensor_msgs, CameraInfo);
STRATA_MESSAGE_TYPE(sensor_msgs, Image);
STRATA_MESSAGE_TYPE(sensor_msgs, LaserScan);
STRATA_MESSAGE_TYPE(sensor_msgs, PointCloud2);
STRATA_MESSAGE_TYPE(std_msgs, Float64);
STRATA_MESSAGE_TYPE(tf2_msgs, TFMessage);
STRATA_MESSAGE_TYPE(strata_msgs, Ack);
STRATA_MESSAGE_TYPE(strata_msgs, LabeledScan);
STRATA_MESSAGE_TYPE(strata_msgs, LocalizationHealth);
STRATA_MESSAGE_TYPE(strata_msgs, NodeMap);
STRATA_MESSAGE_TYPE(strata_msgs, PatchMap);
STRATA_MESSAGE_TYPE(strata_msgs, ReflectionGrid);
STRATA_MESSAGE_TYPE(strata_msgs, ScanPose);
STRATA_MESSAGE_TYPE(strata_msgs, Step);
STRATA_MESSAGE_TYPE(strata_msgs, SubmapStates);
STRATA_MESSAGE_TYPE(strata_msgs, Topologies);
STRATA_MESSAGE_TYPE(strata_msgs, Trajectory);

#undef STRATA_MESSAGE_TYPE

/// ServiceType<S> has the name, "package/srv/Name", and the generated classes Request and Response
/// of the service that the tag struct S in bus::srv stands for.
template <typename S>
struct ServiceType;

#define STRATA_SERVICE_TYPE(package, type)                      \
  namespace srv {                                               \
  struct type;                                                  \
  }                                                             \
  template <>                                                   \
  struct ServiceType<srv::type> {                               \
    static constexpr const char* name = #package "/srv/" #type; \
    using Request = package::srv::type##_Request;               \
    using Response = package::srv::type##_Response;             \
  }

STRATA_SERVICE_TYPE(lifecycle_msgs, ChangeState);
STRATA_SERVICE_TYPE(lifecycle_msgs, GetState);
STRATA_SERVICE_TYPE(lifecycle_msgs, GetAvailableStates);
STRATA_SERVICE_TYPE(lifecycle_msgs, GetAvailableTransitions);
STRATA_SERVICE_TYPE(nav2_msgs, LoadMap);
STRATA_SERVICE_TYPE(nav2_msgs, SaveMap);
STRATA_SERVICE_TYPE(nav2_msgs, SetInitialPose);
STRATA_SERVICE_TYPE(nav_msgs, GetMap);
STRATA_SERVICE_TYPE(rcl_interfaces, DescribeParameters);
STRATA_SERVICE_TYPE(rcl_interfaces, GetParameters);
STRATA_SERVICE_TYPE(rcl_interfaces, GetParameterTypes);
STRATA_SERVICE_TYPE(rcl_interfaces, ListParameters);
STRATA_SERVICE_TYPE(rcl_interfaces, SetParameters);
STRATA_SERVICE_TYPE(rcl_interfaces, SetParametersAtomically);
STRATA_SERVICE_TYPE(std_srvs, Empty);
STRATA_SERVICE_TYPE(std_srvs, Trigger);
STRATA_SERVICE_TYPE(type_description_interfaces, GetTypeDescription);

#undef STRATA_SERVICE_TYPE

}  // namespace strata::bus
