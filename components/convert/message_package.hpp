// SPDX-License-Identifier: Apache-2.0
/// Messages of idl/ as a package that ROS 2 builds, so that its tools know types that only we have.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace strata::convert {

/// A file of a package.
struct PackageFile {
  std::string path;  ///< in the folder of the package, "msg/Pose2.msg"
  std::string text;
};

/// An ament package of all messages and services that the IDL has of `package` ("strata_msgs"),
/// with the comments of the IDL: package.xml, CMakeLists.txt, msg/*.msg, srv/*.srv. ROS 2 makes the
/// same type hashes of it as type_hash. Empty when there is none of that name. O(text).
[[nodiscard]] std::vector<PackageFile> message_package(std::string_view package,
                                                       std::string_view version);

}  // namespace strata::convert
