// SPDX-License-Identifier: Apache-2.0
#include "components/convert/message_definitions.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "components/convert/idl_reader.hpp"

namespace strata::convert {
namespace {

void collect(const std::string& name, std::vector<std::string>& order) {
  if (std::find(order.begin(), order.end(), name) != order.end()) return;
  order.push_back(name);
  for (const std::string& used : idl_definitions().at(name).uses) collect(used, order);
}

/// "std_msgs/Header" of "std_msgs/msg/Header".
std::string short_name(std::string_view type) {
  const std::size_t first = std::min(type.find('/'), type.size());
  const std::size_t last = type.rfind('/');
  return std::string(type.substr(0, first)) +
         (last == std::string_view::npos ? "" : std::string(type.substr(last)));
}

}  // namespace

std::string message_definition(std::string_view type) {
  const std::string name = short_name(type);
  if (!idl_definitions().contains(name)) return {};
  std::vector<std::string> order;
  collect(name, order);
  std::string text = idl_definitions().at(name).text;
  for (std::size_t i = 1; i < order.size(); ++i) {
    text +=
        std::string(80, '=') + "\nMSG: " + order[i] + "\n" + idl_definitions().at(order[i]).text;
  }
  return text;
}

const MessageLayout* message_layout(std::string_view type) {
  const auto found = idl_definitions().find(short_name(type));
  return found == idl_definitions().end() ? nullptr : &found->second.layout;
}

}  // namespace strata::convert
