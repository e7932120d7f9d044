// SPDX-License-Identifier: Apache-2.0
/// What ROS 2 makes of .msg and .srv files, written without a look at ours: type descriptions and
/// their hashes as REP 2016 and rosidl's type description (Iron and later) say.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace strata::test {

class RosTypes {
 public:
  struct Field {
    std::string type;  ///< without its brackets
    std::string name;
    std::string array;  ///< between them; "-" for none
  };
  struct Constant {
    std::string type, name, value;
  };
  struct Message {
    std::vector<Field> fields;
    std::vector<Constant> constants;
    std::vector<std::string> comments;  ///< lines of their own and behind fields
  };

  /// name: "std_msgs/msg/Header", "std_srvs/srv/SetBool" (requests and responses get names of their
  /// own). Throws std::runtime_error for a line that is none of a .msg.
  void add(const std::string& name, const std::string& text);
  [[nodiscard]] const Message& message(const std::string& name) const { return messages_.at(name); }
  /// "RIHS01_..."; throws std::out_of_range when a type that it uses was not added.
  [[nodiscard]] std::string hash(const std::string& name) const;

 private:
  [[nodiscard]] std::string described(const std::string& name) const;
  std::map<std::string, Message> messages_;
};

}  // namespace strata::test
