#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/check-hidden-names names what a source file hides under a header's name, and nothing else.
usage: hidden_names_test.py tools/check-hidden-names"""
import os
import subprocess
import sys
import tempfile

HEADER = """namespace strata {
inline constexpr int kLimit = 5;
struct Ray {
};
using Bytes = int;
[[nodiscard]] double share(double part, std::string_view name);
double spread(std::span<const float> values,
              const Pose2& about = {});
template <class T>
T biggest(T a, T b);
}  // namespace strata
"""
SOURCE = """namespace strata{inside} {{
namespace {{

{line}

}}  // namespace
}}  // namespace strata{inside}
"""
TAKEN = ["constexpr std::size_t kLimit = 2;", "const int kLimit[2] = {1, 2};", "struct Ray {\n};", "class Ray final : public Line {\n};",
         "using Bytes = std::vector<char>;", "enum class Ray { kA };", "float share(int part, const std::string& name) {",
         "double spread(const std::vector<float>& v, const Pose2& about) {"]
FREE = ["constexpr int kOtherLimit = 2;", "struct RayHit {\n};", "double share(const Pose2& pose, const std::string& name) {",
        "double share(double part) {", "  int kLimit = 3;", "double biggest(double a, double b) {"]


def found(line, inside, hidden=True):
    """What the tool says of a source file with that line: its exit code and text."""
    with tempfile.TemporaryDirectory() as root:
        os.makedirs(f"{root}/core")
        with open(f"{root}/core/header.hpp", "w") as out:
            out.write(HEADER)
        with open(f"{root}/core/source.cpp", "w") as out:
            text = SOURCE.format(line=line, inside=inside)
            out.write(text if hidden else text.replace("namespace {\n", "").replace("}  // namespace\n", ""))
        done = subprocess.run([sys.executable, sys.argv[1], root], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr


def expect(line, inside, code, hidden=True):
    result, text = found(line, inside, hidden)
    if result != code or (code == 1 and "core/source.cpp: " not in text):
        sys.exit(f"{line!r} in strata{inside} gave {result}, not {code}:\n{text}")


for inside in ("", "::slam"):
    for line in TAKEN:
        expect(line, inside, 1)
        expect(line, inside, 0, hidden=False)  # a name that all see is the linker's business
    for line in FREE:
        expect(line, inside, 0)
expect("constexpr int kLimit = 2;", "_other", 0)  # no namespace around it has that header's name
