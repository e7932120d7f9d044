// SPDX-License-Identifier: Apache-2.0
#include "components/convert/type_description.hpp"

#include <map>
#include <sstream>
#include <utility>

#include "components/convert/message_definitions.hpp"

namespace strata::convert {
namespace {

/// Type ids of type_description_interfaces/msg/FieldType.
constexpr int kNestedType = 1;
constexpr int kBoundedString = 21;
constexpr int kArrayOffset = 48;
constexpr int kBoundedSequenceOffset = 96;
constexpr int kSequenceOffset = 144;

constexpr std::string_view kBoundedStringPrefix = "string<=";

int scalar_id(const std::string& name) {
  static const std::map<std::string, int> ids = {
      {"int8", 2},   {"uint8", 3}, {"int16", 4},  {"uint16", 5},   {"int32", 6},
      {"uint32", 7}, {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11},
      {"char", 13},  {"bool", 15}, {"byte", 16},  {"string", 17}};
  const auto found = ids.find(name);
  return found == ids.end() ? kNestedType : found->second;
}

/// Where idl/ writes a field otherwise than ROS 2, for the sake of the generators, which changes no
/// byte on the wire: {type, its line} and the line that ROS 2 has.
const std::string& line_of_ros(const std::string& type, const std::string& line) {
  using Line = std::pair<std::string, std::string>;
  static const std::map<Line, std::string> others = {
      {{"nav_msgs/srv/GetMap_Response", "nav_msgs/OccupancyGrid grid"},
       "nav_msgs/OccupancyGrid map"},
      {{"nav2_msgs/srv/LoadMap_Response", "nav_msgs/OccupancyGrid grid"},
       "nav_msgs/OccupancyGrid map"},
      {{"rmw_dds_common/msg/NodeEntitiesInfo", "string node_namespace"},
       "string<=256 node_namespace"},
      {{"rmw_dds_common/msg/NodeEntitiesInfo", "string node_name"}, "string<=256 node_name"},
      {{"type_description_interfaces/msg/FieldType", "string nested_type_name"},
       "string<=255 nested_type_name"},
      {{"type_description_interfaces/msg/IndividualTypeDescription", "string type_name"},
       "string<=255 type_name"}};
  const auto found = others.find({type, line});
  return found == others.end() ? line : found->second;
}

/// "std_msgs/msg/Header" of "std_msgs/Header"; what is full already stays.
std::string full_name(const std::string& name) {
  const std::size_t slash = name.find('/');
  if (name.rfind('/') != slash) return name;
  return name.substr(0, slash) + "/msg" + name.substr(slash);
}

/// A field's line of a .msg text: "float32[] ranges", "uint8[16] gid", "Request[<=1] request".
DescribedField read_field(const std::string& line) {
  const std::size_t blank = line.find(' ');
  std::string type = line.substr(0, blank);
  DescribedField field;
  field.name = line.substr(blank + 1);
  if (type.starts_with(kBoundedStringPrefix)) {
    field.type_id = kBoundedString;
    field.string_capacity = std::stoull(type.substr(kBoundedStringPrefix.size()));
    return field;
  }
  int offset = 0;
  if (const std::size_t bracket = type.find('['); bracket != std::string::npos) {
    std::string capacity = type.substr(bracket + 1, type.size() - bracket - 2);
    offset = capacity.empty() ? kSequenceOffset : kArrayOffset;
    if (capacity.starts_with("<=")) {
      offset = kBoundedSequenceOffset;
      capacity.erase(0, 2);
    }
    if (!capacity.empty()) field.capacity = std::stoull(capacity);
    type.resize(bracket);
  }
  const int id = scalar_id(type);
  if (id == kNestedType) field.nested_type = full_name(type);
  field.type_id = static_cast<std::uint8_t>(id + offset);
  return field;
}

/// The lines of the fields of each type, by its full name, sorted as referenced types must be.
using Types = std::map<std::string, std::vector<std::string>>;

/// "uint8 FLOAT64=8", but not "Range[<=1] range".
bool is_constant(const std::string& line) {
  const std::size_t sign = line.find('=');
  return sign != std::string::npos && (sign == 0 || line[sign - 1] != '<');
}

/// Adds a message and all that it contains; false for one that we do not know.
bool add_message(const std::string& type, Types& types) {
  std::istringstream text(message_definition(type));
  if (text.peek() == std::istringstream::traits_type::eof()) return false;
  std::string current = type;
  types[current].clear();
  for (std::string line; std::getline(text, line);) {
    constexpr std::string_view kPart = "MSG: ";
    if (line.starts_with(kPart)) {
      current = full_name(line.substr(kPart.size()));
      types[current].clear();
    } else if (!line.empty() && !is_constant(line)) {
      types[current].push_back(line_of_ros(current, line));
    }
  }
  return true;
}

/// The event is described though nobody need publish it.
bool add_service(const std::string& type, Types& types) {
  const std::string request = type + "_Request";
  const std::string response = type + "_Response";
  if (!add_message(request, types) || !add_message(response, types)) return false;
  if (!add_message("builtin_interfaces/msg/Time", types)) return false;
  const std::string info = "service_msgs/msg/ServiceEventInfo";
  types[info] = {"uint8 event_type", "builtin_interfaces/msg/Time stamp", "uint8[16] client_gid",
                 "int64 sequence_number"};
  types[type + "_Event"] = {info + " info", request + "[<=1] request", response + "[<=1] response"};
  types[type] = {request + " request_message", response + " response_message",
                 type + "_Event event_message"};
  return true;
}

DescribedType describe(const std::string& name, const std::vector<std::string>& lines) {
  DescribedType type{name, {}};
  for (const std::string& line : lines) type.fields.push_back(read_field(line));
  return type;
}

}  // namespace

bool is_service_type(std::string_view type) {
  return type.find("/srv/") != std::string_view::npos && !type.ends_with("_Request") &&
         !type.ends_with("_Response") && !type.ends_with("_Event");
}

std::optional<TypeDescription> describe_type(std::string_view type) {
  const std::string top(type);
  Types types;
  if (!(is_service_type(type) ? add_service(top, types) : add_message(top, types))) {
    return std::nullopt;
  }
  TypeDescription description{describe(top, types.at(top)), {}};
  for (const auto& [name, lines] : types) {
    if (name != top) description.referenced.push_back(describe(name, lines));
  }
  return description;
}

}  // namespace strata::convert
