# SPDX-License-Identifier: Apache-2.0
# python3 read_messages.py PACKAGE: reads every file of the package that `strata messages` wrote with
# rosidl's own parser (Debian's python3-rosidl), which refuses names and types that ROS 2 would.
# Exits with 77 where that is not installed.
import pathlib
import sys
import xml.etree.ElementTree as xml

sys.path.append("/usr/lib/python3/dist-packages")  # where Debian has it, for another python3 too
try:
    from rosidl_adapter import parser
except ImportError:
    print("rosidl_adapter is not installed")
    sys.exit(77)

package = pathlib.Path(sys.argv[1])
name = xml.parse(package / "package.xml").findtext("name")
assert parser.is_valid_package_name(name), name
messages = {}
for file in sorted(package.glob("msg/*.msg")):
    messages[file.stem] = parser.parse_message_file(name, str(file))
services = [parser.parse_service_file(name, str(file)) for file in package.glob("srv/*.srv")]
assert len(messages) > 20, messages.keys()

# Every type is one of rosidl's, of this package or of one that the manifest names.
depends = {e.text for e in xml.parse(package / "package.xml").iter("depend")}
known = [message.base_type for message in messages.values()]
for message in list(messages.values()) + [m for s in services for m in (s.request, s.response)]:
    for field in message.fields:
        of = field.type.pkg_name
        if of in depends:
            known.append(parser.BaseType(of + "/" + field.type.type))
    parser.validate_field_types(message, known)

health = {field.name: str(field.type) for field in messages["LocalizationHealth"].fields}
assert health["localized"] == "bool" and health["position_std"] == "float64", health
constants = {constant.name: constant.value for constant in messages["Step"].constants}
assert constants["STEP_CYCLE"] == 2, constants
