// SPDX-License-Identifier: Apache-2.0
/// What others leave in /dev/shm under the names that Fast DDS uses ends no process of ours: files
/// of another release, damaged ones, another user's.
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/network/network_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {
namespace {

using testing::HasSubstr;

constexpr const char* kUser = "61001";
constexpr const char* kOtherUser = "61002";

/// "$f": the file; run for every port of domain 0, of ours and of Fast DDS' usual numbers.
/// "$genuine" is a port's file that Fast DDS has made.
struct Foreign {
  std::string name;
  std::string command;
};

void PrintTo(const Foreign& foreign, std::ostream* out) { *out << foreign.name; }

const std::vector<Foreign>& kinds() {
  // Another release's node has another size, which stands 8 bytes before it; its name stands
  // behind.
  static const std::vector<Foreign> kKinds = {
      {"OfAnotherLayout",
       R"sh(python3 -c "
import struct
bytes = bytearray(open('$genuine', 'rb').read())
name = bytes.find(b'port_node_abi')
for at in range(0, 4096, 8):
    (size,) = struct.unpack_from('<Q', bytes, at)
    if at + 8 + (size & 0xFFFFFFFF) == name:
        struct.pack_into('<I', bytes, at, (size & 0xFFFFFFFF) - 16)
        bytes[name - 16:name] = bytes[name:name + 16]
        open('$f', 'wb').write(bytes)")sh"},
      {"OfZeros", "head -c 65536 /dev/zero > $f"},
      {"Empty", ": > $f"},
      {"OfOnes", R"(head -c 65536 /dev/zero | tr '\0' '\377' > $f)"},
      {"OfRandomBytes", "head -c 65536 /dev/urandom > $f"},
      {"CutShort", "head -c 300 $genuine > $f"},
      {"ThatMayNotBeRead", "cp $genuine $f; chmod 000 $f"},
      {"ThatAreFolders", "mkdir $f"},
  };
  return kKinds;
}

class SharedFiles : public Network, public testing::WithParamInterface<Foreign> {
 protected:
  /// Makes the files as that user.
  void put_files(const std::string& user) {
    const std::string genuine = "/dev/shm/genuine";
    {
      const auto maker = peer(0, {"map", "10"}, "shared_memory");
      network_->set_up(0, "cp $(ls /dev/shm/fastrtps_port*[0-9] | head -n 1) " + genuine +
                              " && chmod 644 " + genuine);
    }
    network_->set_up(0,
                     "rm -rf /dev/shm/fastrtps_* /dev/shm/sem.* /dev/shm/strata_*; "
                     "chmod 1777 /dev/shm");
    const TemporaryDirectory folder;
    const auto script = folder.path() / "put_files";
    std::ofstream(script) << "set -e\ngenuine=" << genuine
                          << "\nfor n in $(seq 7362 7435); do f=/dev/shm/fastrtps_port$n\n"
                          << GetParam().command << "\ndone\n";
    network_->set_up(0, "setpriv --reuid=" + user + " --regid=" + user +
                            " --clear-groups sh -s < " + script.string());
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> person(const std::string& transport,
                                                     const std::string& number) const {
    auto process = network_->run(
        0, {"setpriv", std::string("--reuid=") + kUser, std::string("--regid=") + kUser,
            "--clear-groups", STRATA_NETWORK_PEER, transport, "meet", number});
    EXPECT_EQ(process->wait_for_line("ready"), "ready");
    return process;
  }
  void expect_meeting(const std::string& transport) const {
    const auto first = person(transport, "1");
    const auto second = person(transport, "2");
    EXPECT_EQ(first->wait_for_line("met", kPatience), "met 2") << transport;
    EXPECT_EQ(second->wait_for_line("met", kPatience), "met 1") << transport;
    for (ChildProcess* process : {first.get(), second.get()}) {
      process->close_input();
      EXPECT_EQ(process->wait(), 0) << transport;
    }
  }
};

TEST_P(SharedFiles, OfOthersAreNotTouchedWithoutSharedMemory) {
  STRATA_MAKE_HOSTS(1);
  put_files(kOtherUser);
  for (const char* transport : {"default", "localhost", "wifi"}) expect_meeting(transport);
}

TEST_P(SharedFiles, OfOnesOwnUserAreClearedAwayWhereMemoryIsShared) {
  STRATA_MAKE_HOSTS(1);
  put_files(kUser);
  if (GetParam().name == "ThatAreFolders") network_->set_up(0, "rmdir /dev/shm/fastrtps_port*");
  expect_meeting("shared_memory");
}

TEST_P(SharedFiles, OfAnotherUserAreRefusedWhereMemoryIsShared) {
  STRATA_MAKE_HOSTS(1);
  put_files(kOtherUser);
  const auto process = network_->run(
      0, {"setpriv", std::string("--reuid=") + kUser, std::string("--regid=") + kUser,
          "--clear-groups", STRATA_PROGRAM, "run",
          STRATA_SOURCE_DIR "/components/config/mapping.yaml", "--set", "transport=shared_memory"});
  const std::string said = process->rest();
  EXPECT_EQ(process->wait(), 1) << said;
  EXPECT_THAT(said, HasSubstr("strata run: error: /dev/shm/fastrtps_port"));
  EXPECT_THAT(said, HasSubstr("belongs to another user"));
  EXPECT_THAT(said, HasSubstr("use transport: default"));
}

const auto kNameOfForeign = [](const testing::TestParamInfo<Foreign>& info) {
  return info.param.name;
};

INSTANTIATE_TEST_SUITE_P(Foreign, SharedFiles, testing::ValuesIn(kinds()), kNameOfForeign);

}  // namespace
}  // namespace strata::test
