// SPDX-License-Identifier: Apache-2.0
#include "components/convert/type_description_messages.hpp"

#include <optional>
#include <string>

#include "components/convert/message_definitions.hpp"
#include "components/convert/type_description.hpp"
#include "components/convert/type_hash.hpp"

namespace strata::convert {
namespace {

namespace msg = type_description_interfaces::msg;
namespace srv = type_description_interfaces::srv;

msg::IndividualTypeDescription to_message(const DescribedType& type) {
  msg::IndividualTypeDescription message;
  message.type_name(type.name);
  for (const DescribedField& field : type.fields) {
    msg::Field entry;
    entry.name(field.name);
    entry.type().type_id(field.type_id);
    entry.type().capacity(field.capacity);
    entry.type().string_capacity(field.string_capacity);
    entry.type().nested_type_name(field.nested_type);
    message.fields().push_back(entry);
  }
  return message;
}

/// The type's own text, without those that it contains.
std::string own_text(const std::string& type) {
  const std::string all = message_definition(type);
  const std::string own = all.substr(0, all.find("====="));
  // A member that only the wire needs.
  return own == "uint8 structure_needs_at_least_one_member\n" ? "" : own;
}

msg::TypeSource source_of(const std::string& type) {
  msg::TypeSource source;
  source.type_name(type);
  if (is_service_type(type)) {
    source.encoding("srv");
    source.raw_file_contents(own_text(type + "_Request") + "---\n" + own_text(type + "_Response"));
  } else if (type.find("/srv/") != std::string::npos || message_definition(type).empty()) {
    source.encoding("implicit");  // ROS 2's word for what has no file of its own
  } else {
    source.encoding("msg");
    source.raw_file_contents(own_text(type));
  }
  return source;
}

srv::GetTypeDescription_Response failure(const std::string& reason) {
  srv::GetTypeDescription_Response response;
  response.successful(false);
  response.failure_reason(reason);
  return response;
}

}  // namespace

srv::GetTypeDescription_Response answer(const srv::GetTypeDescription_Request& request) {
  const std::string& type = request.type_name();
  const std::optional<TypeDescription> description = describe_type(type);
  if (!description) return failure("'" + type + "' is not known here");
  const std::string hash = type_hash(type);
  if (!request.type_hash().empty() && request.type_hash() != hash) {
    return failure("'" + type + "' has the hash " + hash + " here");
  }
  srv::GetTypeDescription_Response response;
  response.successful(true);
  response.type_description().type_description(to_message(description->type));
  for (const DescribedType& referenced : description->referenced) {
    response.type_description().referenced_type_descriptions().push_back(to_message(referenced));
  }
  if (!request.include_type_sources()) return response;
  response.type_sources().push_back(source_of(type));
  for (const DescribedType& referenced : description->referenced) {
    response.type_sources().push_back(source_of(referenced.name));
  }
  return response;
}

}  // namespace strata::convert
