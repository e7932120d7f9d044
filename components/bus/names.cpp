// SPDX-License-Identifier: Apache-2.0
#include "components/bus/names.hpp"

#include <algorithm>
#include <cctype>

#include "core/base/error.hpp"

namespace strata::bus {
namespace {

void require_ros_name(const std::string& full_name) {
  const bool well_formed =
      std::all_of(full_name.begin(), full_name.end(),
                  [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '/'; }) &&
      full_name.size() > 1 && full_name.back() != '/' && full_name.find("//") == std::string::npos;
  if (!well_formed) {
    throw ConfigError(full_name, "is not a ROS 2 name",
                      "use letters, digits, '_' and single '/', as in /robot1/scan");
  }
}

std::string joined(const std::string& scope, const std::string& name) {
  std::string result = scope.empty() || scope.front() != '/' ? "/" + scope : scope;
  if (result.back() != '/') result += '/';
  return result + name;
}

}  // namespace

std::string expand_name(const std::string& name, const std::string& node_namespace,
                        const std::string& node_name) {
  std::string full;
  if (!name.empty() && name.front() == '/') {
    full = name;
  } else if (name.rfind("~/", 0) == 0) {
    full = joined(joined(node_namespace, node_name), name.substr(2));
  } else {
    full = joined(node_namespace, name);
  }
  require_ros_name(full);
  return full;
}

std::string resolve_name(const std::string& name, const std::string& node_namespace,
                         const std::string& node_name, const Remappings& remappings) {
  const std::string full = expand_name(name, node_namespace, node_name);
  for (const auto& [from, to] : remappings) {
    if (expand_name(from, node_namespace, node_name) == full) {
      return expand_name(to, node_namespace, node_name);
    }
  }
  return full;
}

std::string wire_topic(const TopicName& name) {
  switch (name.kind) {
    case TopicKind::kTopic:
      return "rt" + name.full;
    case TopicKind::kRequest:
      return "rq" + name.full + "Request";
    case TopicKind::kReply:
      return "rr" + name.full + "Reply";
    case TopicKind::kPlain:
      break;
  }
  return name.full;
}

std::string topic_from_wire(std::string_view wire_name) {
  return wire_name.substr(0, 3) == "rt/" ? std::string(wire_name.substr(2)) : std::string();
}

std::string wire_type(std::string_view ros_type) {
  const std::size_t first = ros_type.find('/');
  const std::size_t last = ros_type.rfind('/');
  if (first == std::string_view::npos || first == last) {
    throw ConfigError(std::string(ros_type), "is not a ROS 2 type", "spell it as package/msg/Name");
  }
  return std::string(ros_type.substr(0, first)) +
         "::" + std::string(ros_type.substr(first + 1, last - first - 1)) +
         "::dds_::" + std::string(ros_type.substr(last + 1)) + "_";
}

std::string type_from_wire(std::string_view wire_name) {
  const std::size_t first = wire_name.find("::");
  const std::size_t mark = wire_name.find("::dds_::");
  if (first == std::string_view::npos || mark == std::string_view::npos || first >= mark ||
      wire_name.back() != '_') {
    return {};
  }
  const std::size_t name = mark + 8;
  return std::string(wire_name.substr(0, first)) + "/" +
         std::string(wire_name.substr(first + 2, mark - first - 2)) + "/" +
         std::string(wire_name.substr(name, wire_name.size() - name - 1));
}

}  // namespace strata::bus
