// SPDX-License-Identifier: Apache-2.0
/// What a message or service type consists of, as ROS 2 describes it to others (REP 2016).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace strata::convert {

/// As type_description_interfaces/msg/Field and FieldType.
struct DescribedField {
  std::string name;
  std::uint8_t type_id = 0;
  std::uint64_t capacity = 0;         ///< of an array, most of a bounded sequence
  std::uint64_t string_capacity = 0;  ///< most of a bounded string
  std::string nested_type;            ///< "std_msgs/msg/Header"
};

struct DescribedType {
  std::string name;
  std::vector<DescribedField> fields;
};

/// A type and all that it contains, the latter sorted by name.
struct TypeDescription {
  DescribedType type;
  std::vector<DescribedType> referenced;
};

/// Of "std_msgs/msg/Header" or "std_srvs/srv/Empty"; none for types we do not know. A service has
/// three members: what is asked, what is answered, and the event by which ROS 2 lets others watch
/// it. O(description).
[[nodiscard]] std::optional<TypeDescription> describe_type(std::string_view type);

/// Whether it names a service as a whole, not its request or response.
[[nodiscard]] bool is_service_type(std::string_view type);

}  // namespace strata::convert
