// SPDX-License-Identifier: Apache-2.0
/// ROS 2 message definitions for MCAP schemas, which viewers need to decode messages.
#include <map>
#include <string>
#include <vector>

#include "components/log/bag_storage.hpp"

namespace strata::log {
namespace {

struct Definition {
  const char* text;
  std::vector<const char*> uses;
};

const std::map<std::string, Definition>& definitions() {
  static const std::map<std::string, Definition> all = {
      {"builtin_interfaces/Time", {"int32 sec\nuint32 nanosec\n", {}}},
      {"std_msgs/Header",
       {"builtin_interfaces/Time stamp\nstring frame_id\n", {"builtin_interfaces/Time"}}},
      {"std_msgs/String", {"string data\n", {}}},
      {"geometry_msgs/Point", {"float64 x\nfloat64 y\nfloat64 z\n", {}}},
      {"geometry_msgs/Vector3", {"float64 x\nfloat64 y\nfloat64 z\n", {}}},
      {"geometry_msgs/Quaternion", {"float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", {}}},
      {"geometry_msgs/Pose",
       {"geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        {"geometry_msgs/Point", "geometry_msgs/Quaternion"}}},
      {"geometry_msgs/PoseStamped",
       {"std_msgs/Header header\ngeometry_msgs/Pose pose\n",
        {"std_msgs/Header", "geometry_msgs/Pose"}}},
      {"geometry_msgs/PoseWithCovariance",
       {"geometry_msgs/Pose pose\nfloat64[36] covariance\n", {"geometry_msgs/Pose"}}},
      {"geometry_msgs/PoseWithCovarianceStamped",
       {"std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n",
        {"std_msgs/Header", "geometry_msgs/PoseWithCovariance"}}},
      {"geometry_msgs/Twist",
       {"geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
        {"geometry_msgs/Vector3"}}},
      {"geometry_msgs/TwistWithCovariance",
       {"geometry_msgs/Twist twist\nfloat64[36] covariance\n", {"geometry_msgs/Twist"}}},
      {"geometry_msgs/Transform",
       {"geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
        {"geometry_msgs/Vector3", "geometry_msgs/Quaternion"}}},
      {"geometry_msgs/TransformStamped",
       {"std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
        {"std_msgs/Header", "geometry_msgs/Transform"}}},
      {"tf2_msgs/TFMessage",
       {"geometry_msgs/TransformStamped[] transforms\n", {"geometry_msgs/TransformStamped"}}},
      {"sensor_msgs/LaserScan",
       {"std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
        "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
        "float32[] ranges\nfloat32[] intensities\n",
        {"std_msgs/Header"}}},
      {"nav_msgs/Odometry",
       {"std_msgs/Header header\nstring child_frame_id\n"
        "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n",
        {"std_msgs/Header", "geometry_msgs/PoseWithCovariance",
         "geometry_msgs/TwistWithCovariance"}}},
      {"nav_msgs/MapMetaData",
       {"builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\n"
        "uint32 height\ngeometry_msgs/Pose origin\n",
        {"builtin_interfaces/Time", "geometry_msgs/Pose"}}},
      {"nav_msgs/OccupancyGrid",
       {"std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
        {"std_msgs/Header", "nav_msgs/MapMetaData"}}},
      {"nav2_msgs/Particle", {"geometry_msgs/Pose pose\nfloat64 weight\n", {"geometry_msgs/Pose"}}},
      {"nav2_msgs/ParticleCloud",
       {"std_msgs/Header header\nnav2_msgs/Particle[] particles\n",
        {"std_msgs/Header", "nav2_msgs/Particle"}}},
      {"rosgraph_msgs/Clock", {"builtin_interfaces/Time clock\n", {"builtin_interfaces/Time"}}},
  };
  return all;
}

void collect(const std::string& name, std::vector<std::string>& order) {
  for (const std::string& known : order) {
    if (known == name) return;
  }
  order.push_back(name);
  for (const char* used : definitions().at(name).uses) collect(used, order);
}

}  // namespace

std::string message_definition(const std::string& type) {
  std::string name = type;
  if (const auto at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
  if (!definitions().contains(name)) return {};
  std::vector<std::string> order;
  collect(name, order);
  std::string text = definitions().at(name).text;
  for (std::size_t i = 1; i < order.size(); ++i) {
    text += std::string(80, '=') + "\nMSG: " + order[i] + "\n" + definitions().at(order[i]).text;
  }
  return text;
}

}  // namespace strata::log
