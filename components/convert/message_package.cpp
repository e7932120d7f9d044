// SPDX-License-Identifier: Apache-2.0
#include "components/convert/message_package.hpp"

#include <set>

#include "components/convert/idl_reader.hpp"

namespace strata::convert {
namespace {

constexpr std::string_view kRequest = "_Request";
constexpr std::string_view kResponse = "_Response";

/// Without the member that rosidl itself puts into an empty struct.
std::string without_filler(std::string text) {
  constexpr std::string_view kFiller = "uint8 structure_needs_at_least_one_member\n";
  if (const std::size_t at = text.find(kFiller); at != std::string::npos) {
    text.erase(at, kFiller.size());
  }
  return text;
}

/// What belongs to a package.
struct Contents {
  std::vector<PackageFile> files;
  std::set<std::string> depends;  ///< packages whose messages are used
};

void add(const std::string& package, const std::string& name, const IdlDefinition& definition,
         Contents& contents) {
  for (const std::string& used : definition.uses) {
    const std::string of = used.substr(0, used.find('/'));
    if (of != package) contents.depends.insert(of);
  }
  if (name.ends_with(kResponse) && definition.kind == "srv") return;  // with its request
  std::string text = without_filler(definition.commented_text);
  std::string file = name;
  if (definition.kind == "srv") {
    file.resize(file.size() - kRequest.size());
    const auto response = idl_definitions().find(package + "/" + file + std::string(kResponse));
    text += "---\n";
    if (response != idl_definitions().end())
      text += without_filler(response->second.commented_text);
  }
  contents.files.push_back({definition.kind + "/" + file + "." + definition.kind, std::move(text)});
}

Contents contents_of(const std::string& package) {
  Contents contents;
  const std::string prefix = package + "/";
  for (auto it = idl_definitions().lower_bound(prefix); it != idl_definitions().end(); ++it) {
    if (!it->first.starts_with(prefix)) break;
    add(package, it->first.substr(prefix.size()), it->second, contents);
  }
  return contents;
}

std::string manifest(const std::string& package, std::string_view version,
                     const std::set<std::string>& depends) {
  std::string text = R"(<?xml version="1.0"?>
<!-- Written by `strata messages`. -->
<package format="3">
  <name>)" + package +
                     R"(</name>
  <version>)" + std::string(version) +
                     R"(</version>
  <description>Messages that Strata publishes and ROS 2 has none for.</description>
  <maintainer email="maintainers@strata.invalid">Strata maintainers</maintainer>
  <license>Apache-2.0</license>

  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
)";
  for (const std::string& depend : depends) text += "  <depend>" + depend + "</depend>\n";
  text += R"(  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>

  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
)";
  return text;
}

std::string build_file(const std::string& package, const Contents& contents) {
  std::string text =
      "# Written by `strata messages`.\ncmake_minimum_required(VERSION 3.8)\nproject(" + package +
      ")\n\nfind_package(ament_cmake REQUIRED)\n"
      "find_package(rosidl_default_generators REQUIRED)\n";
  for (const std::string& depend : contents.depends) {
    text += "find_package(" + depend + " REQUIRED)\n";
  }
  text += "\nrosidl_generate_interfaces(${PROJECT_NAME}\n";
  for (const PackageFile& file : contents.files) text += "  " + file.path + "\n";
  if (!contents.depends.empty()) {
    text += "  DEPENDENCIES";
    for (const std::string& depend : contents.depends) text += " " + depend;
    text += "\n";
  }
  text += ")\n\nament_export_dependencies(rosidl_default_runtime)\nament_package()\n";
  return text;
}

}  // namespace

std::vector<PackageFile> message_package(std::string_view package, std::string_view version) {
  const std::string name(package);
  Contents contents = contents_of(name);
  if (contents.files.empty()) return {};
  std::vector<PackageFile> files = {{"package.xml", manifest(name, version, contents.depends)},
                                    {"CMakeLists.txt", build_file(name, contents)}};
  for (PackageFile& file : contents.files) files.push_back(std::move(file));
  return files;
}

}  // namespace strata::convert
