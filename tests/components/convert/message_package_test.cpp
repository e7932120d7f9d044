// SPDX-License-Identifier: Apache-2.0
#include "components/convert/message_package.hpp"

#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/idl_reader.hpp"
#include "components/convert/type_hash.hpp"
#include "tests/components/convert/ros_types.hpp"

namespace strata::convert {
namespace {

using test::RosTypes;
using testing::Contains;
using testing::HasSubstr;

std::string text_of(const std::vector<PackageFile>& files, const std::string& path) {
  for (const PackageFile& file : files) {
    if (file.path == path) return file.text;
  }
  return "no file " + path;
}

std::vector<PackageFile> ours() { return message_package("strata_msgs", "1.2.3"); }

/// "strata_msgs/msg/Pose2" of "msg/Pose2.msg"; empty for other files.
std::string type_of(const std::string& package, const PackageFile& file) {
  if (!file.path.ends_with(".msg") && !file.path.ends_with(".srv")) return {};
  return package + "/" + file.path.substr(0, file.path.size() - 4);
}

/// The messages of ROS 2 that ours contain, as its own packages have them.
RosTypes types_of_ros2() {
  RosTypes types;
  types.add("builtin_interfaces/msg/Time", "int32 sec\n\nuint32 nanosec\n");
  types.add("std_msgs/msg/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
  types.add("sensor_msgs/msg/LaserScan",
            "std_msgs/Header header # stamp of the first ray\nfloat32 angle_min\n"
            "float32 angle_max\nfloat32 angle_increment\n\nfloat32 time_increment\n"
            "float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
            "float32[] intensities\n");
  types.add("geometry_msgs/msg/Point", "float64 x\nfloat64 y\nfloat64 z\n");
  types.add("geometry_msgs/msg/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
  types.add("geometry_msgs/msg/Pose",
            "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
  types.add("nav_msgs/msg/MapMetaData",
            "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\n"
            "uint32 height\ngeometry_msgs/Pose origin\n");
  types.add("nav_msgs/msg/OccupancyGrid",
            "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n");
  return types;
}

TEST(MessagePackage, HashesOfItsFilesAreThoseOnTheWire) {
  RosTypes types = types_of_ros2();
  ASSERT_EQ(types.hash("sensor_msgs/msg/LaserScan"),
            "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828")
      << "as ROS 2 Jazzy has it";
  std::vector<std::string> names;
  for (const PackageFile& file : ours()) {
    const std::string name = type_of("strata_msgs", file);
    if (name.empty()) continue;
    types.add(name, file.text);
    names.push_back(name);
  }
  for (const std::string& name : names) EXPECT_EQ(types.hash(name), type_hash(name)) << name;
  std::size_t structs = 0;
  for (const auto& [name, definition] : idl_definitions()) {
    structs += name.starts_with("strata_msgs/") && !name.ends_with("_Response") ? 1 : 0;
  }
  EXPECT_EQ(names.size(), structs);
  EXPECT_GT(structs, 20U);
}

TEST(MessagePackage, HashesOfServicesAreThoseOnTheWireToo) {
  RosTypes types = types_of_ros2();
  const auto empty = message_package("std_srvs", "1.0.0");
  ASSERT_EQ(text_of(empty, "srv/Empty.srv"), "---\n");
  types.add("std_srvs/srv/Empty", text_of(empty, "srv/Empty.srv"));
  EXPECT_EQ(types.hash("std_srvs/srv/Empty"), type_hash("std_srvs/srv/Empty"));
  const auto services = message_package("rcl_interfaces", "1.0.0");
  for (const PackageFile& file : services) {
    if (const std::string name = type_of("rcl_interfaces", file); !name.empty()) {
      types.add(name, file.text);
    }
  }
  const std::string name = "rcl_interfaces/srv/GetParameters";
  EXPECT_EQ(types.hash(name),
            "RIHS01_bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc");
  EXPECT_EQ(types.hash(name), type_hash(name));
}

TEST(MessagePackage, CarriesTheCommentsOfTheIdl) {
  const std::string pose = text_of(ours(), "msg/ScanPose.msg");
  EXPECT_THAT(pose, testing::StartsWith("# The pose of one scan. header.stamp is the scan's, "
                                        "header.frame_id the map frame.\n\n"
                                        "std_msgs/Header header\nint32 run\n"));
  EXPECT_THAT(pose, HasSubstr("\nuint64 index  # of the scan, from 0, in the order of arrival\n"));
  // Above an annotation, and of a struct on one line.
  EXPECT_THAT(text_of(ours(), "msg/CellRect.msg"), testing::StartsWith("# Cells min <= (x, y)"));
  EXPECT_THAT(text_of(ours(), "msg/Pose2.msg"),
              testing::Eq("float64 x\nfloat64 y\nfloat64 theta\n"));
  RosTypes types;
  for (const PackageFile& file : ours()) {
    if (const std::string name = type_of("strata_msgs", file); !name.empty()) {
      types.add(name, file.text);
    }
  }
  EXPECT_THAT(types.message("strata_msgs/msg/LocalizationHealth").comments,
              Contains(" nats, of the last scan"));
}

TEST(MessagePackage, ValuesOfAnEnumAreConstantsBeforeItsField) {
  RosTypes types;
  types.add("strata_msgs/msg/Step", text_of(ours(), "msg/Step.msg"));
  const RosTypes::Message& step = types.message("strata_msgs/msg/Step");
  ASSERT_EQ(step.constants.size(), 4U);
  EXPECT_EQ(step.constants[2].type, "uint32");
  EXPECT_EQ(step.constants[2].name, "STEP_CYCLE");
  EXPECT_EQ(step.constants[2].value, "2");
  EXPECT_EQ(step.fields[1].name, "kind");
  EXPECT_THAT(step.comments, Contains(HasSubstr("HELLO: say what you publish and subscribe.")));
}

TEST(MessagePackage, ReadsCommentsWhereverTheyStand) {
  IdlDefinitions read;
  read_idl(
      "// of the file\n\n// of the struct\nmodule a { module msg {\n"
      "  // what a colour is\n  enum Colour { RED,  // as blood\n    GREEN };\n\n"
      "  // apart from what follows\n\n  // of Thing\n  @final struct Thing {\n"
      "    // before it,\n    // in two lines\n    double x;  // behind it,\n"
      "               // and going on\n    // of y\n    long y;\n    Colour colour;\n  };\n}; };\n",
      read);
  const IdlDefinition& thing = read.at("a/Thing");
  EXPECT_EQ(thing.commented_text,
            "# of Thing\n\n# before it,\n# in two lines\nfloat64 x  # behind it, and going on\n"
            "# of y\nint32 y\n# what a colour is\nuint32 RED=0  # as blood\nuint32 GREEN=1\n"
            "uint32 colour\n");
  EXPECT_EQ(thing.text, "float64 x\nint32 y\nuint32 RED=0\nuint32 GREEN=1\nuint32 colour\n");
  EXPECT_EQ(thing.kind, "msg");
}

TEST(MessagePackage, NamesFollowTheRulesOfRosidl) {
  const std::regex message("[A-Z][A-Za-z0-9]*");
  const std::regex field("[a-z](_?[a-z0-9])*");
  const std::regex constant("[A-Z](_?[A-Z0-9])*");
  // Of C++, C, Python and IDL, as far as they could be fields.
  const std::set<std::string> reserved = {
      "and",     "as",       "assert",    "async",    "await",     "bool",      "break",
      "case",    "catch",    "char",      "class",    "const",     "continue",  "def",
      "default", "del",      "delete",    "do",       "double",    "elif",      "else",
      "enum",    "except",   "explicit",  "export",   "extern",    "false",     "finally",
      "float",   "for",      "from",      "friend",   "global",    "goto",      "if",
      "import",  "in",       "inline",    "int",      "interface", "is",        "lambda",
      "long",    "module",   "namespace", "new",      "none",      "nonlocal",  "not",
      "octet",   "operator", "or",        "pass",     "private",   "protected", "public",
      "raise",   "register", "return",    "sequence", "short",     "signed",    "sizeof",
      "static",  "string",   "struct",    "switch",   "template",  "this",      "throw",
      "true",    "try",      "typedef",   "typename", "union",     "unsigned",  "using",
      "virtual", "void",     "volatile",  "while",    "with",      "wstring",   "xor",
      "yield"};
  std::size_t fields = 0;
  for (const PackageFile& file : ours()) {
    const std::string name = type_of("strata_msgs", file);
    if (name.empty()) continue;
    EXPECT_TRUE(std::regex_match(name.substr(name.rfind('/') + 1), message)) << name;
    RosTypes types;
    types.add(name, file.text);
    std::vector<std::string> parts = {name};
    if (file.path.ends_with(".srv")) parts = {name + "_Request", name + "_Response"};
    for (const std::string& part : parts) {
      std::set<std::string> met;
      for (const RosTypes::Field& one : types.message(part).fields) {
        EXPECT_TRUE(std::regex_match(one.name, field)) << part << " " << one.name;
        EXPECT_FALSE(reserved.contains(one.name)) << part << " " << one.name;
        EXPECT_TRUE(met.insert(one.name).second) << part << " has two " << one.name;
        ++fields;
      }
      for (const RosTypes::Constant& one : types.message(part).constants) {
        EXPECT_TRUE(std::regex_match(one.name, constant)) << part << " " << one.name;
      }
    }
  }
  EXPECT_GT(fields, 80U);
}

TEST(MessagePackage, ItsManifestAndBuildFileNameAllThatItNeeds) {
  const auto files = ours();
  const std::string manifest = text_of(files, "package.xml");
  EXPECT_THAT(manifest, HasSubstr("<name>strata_msgs</name>\n  <version>1.2.3</version>"));
  const std::string build = text_of(files, "CMakeLists.txt");
  for (const char* package : {"builtin_interfaces", "nav_msgs", "sensor_msgs", "std_msgs"}) {
    EXPECT_THAT(manifest, HasSubstr("<depend>" + std::string(package) + "</depend>"));
    EXPECT_THAT(build, HasSubstr("find_package(" + std::string(package) + " REQUIRED)"));
  }
  EXPECT_THAT(build,
              HasSubstr("\n  DEPENDENCIES builtin_interfaces nav_msgs sensor_msgs std_msgs\n)"));
  EXPECT_THAT(manifest, HasSubstr("<member_of_group>rosidl_interface_packages<"));
  EXPECT_THAT(manifest, HasSubstr("<build_type>ament_cmake<"));
  for (const PackageFile& file : files) {
    if (type_of("strata_msgs", file).empty()) continue;
    EXPECT_THAT(build, HasSubstr("\n  " + file.path + "\n"));
  }
}

TEST(MessagePackage, AForeignPackageHasNone) {
  EXPECT_TRUE(message_package("foreign_msgs", "1.0.0").empty());
}

}  // namespace
}  // namespace strata::convert
