// SPDX-License-Identifier: Apache-2.0
/// Messages that come over the wire or out of bags; the first byte chooses the type. The corpus
/// names types by their place below: new ones go to the end.
#include "strata_idl/rcl_interfaces.h"
#include "strata_idl/rmw_dds_common.h"
#include "strata_idl/rmw_dds_common_24.h"

#include "components/bus/bag_service_types.hpp"
#include "components/bus/graph_message.hpp"
#include "components/bus/message_types.hpp"
#include "components/bus/service.hpp"
#include "components/bus/site_service_types.hpp"
#include "components/clouds/image_messages.hpp"
#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "components/convert/patch_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/maps/node_map_message.hpp"
#include "components/topologies/topology_messages.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace {

using strata::convert::from_cdr;
using strata::convert::from_message;
using strata::fuzz::Input;
namespace bus = strata::bus;
namespace srv = strata::bus::srv;

/// Also turns the message into what the core works on.
template <typename Message>
void receive(Input bytes) {
  const auto message = from_cdr<Message>(bytes, "fuzz");
  if constexpr (requires { from_message(message); }) (void)from_message(message);
}

void receive_scan(Input bytes) {
  (void)from_message(from_cdr<sensor_msgs::msg::LaserScan>(bytes, "fuzz"), strata::Pose2{});
}

void receive_cloud(Input bytes) {
  const auto message = from_cdr<sensor_msgs::msg::PointCloud2>(bytes, "fuzz");
  const std::size_t points = from_message(message).size();
  const auto columns = strata::convert::columns_of(message);
  for (const std::size_t count : {columns.offset_s.size(), columns.truly_moving.size()}) {
    if (count != 0 && count != points) __builtin_trap();
  }
}

void receive_node_map(Input bytes) {
  const auto message = from_cdr<strata_msgs::msg::NodeMap>(bytes, "fuzz");
  const auto first = strata::maps::from_message(message, {});
  (void)strata::maps::from_message(message, {}, first.get());
}

/// Others' nodes, with the long or the short GIDs; what is read says the same when it is written.
void receive_graph(Input bytes) {
  auto graph = bus::graph_from_cdr({bytes.begin(), bytes.end()});
  if (!graph) return;
  // A string is written up to its first zero, and no name has one.
  for (bus::NodeInfo& node : graph->second) {
    node.name = node.name.c_str();
    node.node_namespace = node.node_namespace.c_str();
  }
  for (const std::size_t gid_bytes : {16, 24}) {
    const auto written = bus::graph_to_cdr(graph->first, graph->second, gid_bytes);
    if (bus::graph_from_cdr(written) != graph) __builtin_trap();
  }
}

template <typename S>
void serve(Input cdr) {
  (void)from_cdr<typename bus::ServiceType<S>::Request>(cdr, bus::ServiceType<S>::name);
}

/// The corpus names these by their place, too: new ones go to the end.
constexpr void (*kServices[])(Input) = {
    serve<srv::ChangeState>,
    serve<srv::GetState>,
    serve<srv::GetAvailableStates>,
    serve<srv::GetAvailableTransitions>,
    serve<srv::LoadMap>,
    serve<srv::SaveMap>,
    serve<srv::SetInitialPose>,
    serve<srv::GetMap>,
    serve<srv::DescribeParameters>,
    serve<srv::GetParameters>,
    serve<srv::GetParameterTypes>,
    serve<srv::ListParameters>,
    serve<srv::SetParameters>,
    serve<srv::SetParametersAtomically>,
    serve<srv::Empty>,
    serve<srv::Pause>,
    serve<srv::Resume>,
    serve<srv::TogglePaused>,
    serve<srv::IsPaused>,
    serve<srv::GetRate>,
    serve<srv::SetRate>,
    serve<srv::PlayNext>,
    serve<srv::Seek>,
    serve<srv::SplitBagfile>,
    serve<srv::GetTypeDescription>,
    serve<srv::Trigger>,
    serve<srv::ListSiteVersions>,
    serve<srv::ApproveSiteVersion>,
    serve<srv::ActivateSiteVersion>,
    serve<srv::RollBackSite>,
    serve<srv::GetSiteVersionMap>,
    serve<srv::SetSiteLevel>,
};

/// The next byte chooses the service, and its highest bit whose client asks: Cyclone's puts a
/// prefix in front.
void receive_request(Input bytes) {
  if (bytes.empty()) return;
  bus::RawMessage message;
  const std::uint16_t vendor = bytes[0] >= 128 ? bus::kVendorCyclone : bus::kVendorFastDds;
  message.identity.writer[0] = static_cast<std::uint8_t>(vendor >> 8);
  message.identity.writer[1] = static_cast<std::uint8_t>(vendor & 0xFF);
  message.cdr.assign(bytes.begin() + 1, bytes.end());
  const bus::ServiceRequest request = bus::read_service_request(message);
  // The reply names the client and has the four bytes of its header besides.
  const std::vector<std::uint8_t> reply = bus::service_reply_bytes(request, {0, 1, 0, 0, 7});
  if (reply.size() != (request.prefix ? 21 : 5)) __builtin_trap();
  kServices[(bytes[0] & 127) % std::size(kServices)](request.cdr);
}

constexpr void (*kKinds[])(Input) = {
    receive_scan,
    receive<nav_msgs::msg::Odometry>,
    receive<tf2_msgs::msg::TFMessage>,
    receive<geometry_msgs::msg::PoseWithCovarianceStamped>,
    receive<nav_msgs::msg::OccupancyGrid>,
    receive<strata_msgs::msg::LabeledScan>,
    receive<strata_msgs::msg::ReflectionGrid>,
    receive<strata_msgs::msg::PatchMap>,
    receive<strata_msgs::msg::Step>,
    receive<strata_msgs::msg::Ack>,
    receive<rmw_dds_common::msg::ParticipantEntitiesInfo>,
    receive<rmw_dds_common_24::msg::ParticipantEntitiesInfo>,
    receive_graph,
    receive_cloud,
    receive<sensor_msgs::msg::Image>,
    receive<sensor_msgs::msg::CameraInfo>,
    receive<strata_msgs::msg::ScanPose>,
    receive_node_map,
    receive<geometry_msgs::msg::PointStamped>,
    receive<rosgraph_msgs::msg::Clock>,
    receive<bond::msg::Status>,
    receive<strata_msgs::msg::Topologies>,
    receive<strata_msgs::msg::SubmapStates>,
    receive<strata_msgs::msg::LocalizationHealth>,
    receive<nav2_msgs::msg::ParticleCloud>,
    receive_request,
    receive<nav_msgs::msg::Path>,
    receive<geometry_msgs::msg::PoseStamped>,
    receive<diagnostic_msgs::msg::DiagnosticArray>,
    receive<rcl_interfaces::msg::ParameterEvent>,
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  return strata::fuzz::expect_value_or_error([&] {
    kKinds[data[0] % std::size(kKinds)]({data + 1, size - 1});
  });
}
