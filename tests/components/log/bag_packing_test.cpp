// SPDX-License-Identifier: Apache-2.0
/// What rosbag2 calls compression_mode: whole files or single messages.
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "components/log/bag.hpp"
#include "components/log/compression.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using test::bytes_of;
using test_log::BagContent;
using test_log::read_bag;
using test_log::write_text;

using Messages = std::vector<std::pair<std::int64_t, Bytes>>;

/// CDR-like: a header and a content that compresses.
Messages some_messages() {
  Messages messages;
  for (std::int64_t i = 0; i < 40; ++i) {
    Bytes data = {0, 1, 0, 0};
    data.resize(static_cast<std::size_t>(100 + 10 * i), static_cast<std::uint8_t>(i));
    messages.emplace_back(1000 * i, data);
  }
  return messages;
}

class Packing : public ::testing::TestWithParam<std::tuple<BagStorage, BagPacking>> {
 protected:
  fs::path write(const Messages& messages) {
    const fs::path bag = folder_.path() / "bag";
    BagWriter writer(
        bag, BagOptions{.storage = std::get<0>(GetParam()), .packing = std::get<1>(GetParam())});
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", "qos"});
    for (const auto& [ns, data] : messages) writer.write(topic, {ns}, data);
    writer.close();
    return bag;
  }
  [[nodiscard]] bool mcap() const { return std::get<0>(GetParam()) == BagStorage::kMcap; }
  [[nodiscard]] bool whole_file() const { return std::get<1>(GetParam()) == BagPacking::kFile; }
  strata::test::TemporaryDirectory folder_;
};

TEST_P(Packing, AMessageComesOutAsItWentIn) {
  const fs::path bag = write(some_messages());
  const BagContent content = read_bag(bag);
  EXPECT_EQ(content.messages, some_messages());
  EXPECT_EQ(content.damage.count, 0U) << content.damage.first;
  EXPECT_THAT(content.description, ::testing::HasSubstr("packed"));
  const std::string metadata = bytes_of(bag / "metadata.yaml");
  EXPECT_THAT(metadata, ::testing::HasSubstr("compression_format: \"zstd\""));
  EXPECT_THAT(metadata, ::testing::HasSubstr(whole_file() ? "compression_mode: \"FILE\""
                                                          : "compression_mode: \"MESSAGE\""));
}

TEST_P(Packing, IsKnownByContentWhereMetadataIsLostOrAFileIsGivenAlone) {
  const fs::path bag = write(some_messages());
  fs::remove(bag / "metadata.yaml");
  EXPECT_EQ(read_bag(bag).messages, some_messages());
  const std::string name = std::string("bag_0") + (mcap() ? ".mcap" : ".db3");
  EXPECT_EQ(read_bag(bag / (whole_file() ? name + ".zstd" : name)).messages, some_messages());
}

TEST_P(Packing, TakesAwayTheUnpackedCopyOfAProcessThatWasKilled) {
  const fs::path bag = write(some_messages());
  const fs::path file = bag / (std::string("bag_0") + (mcap() ? ".mcap" : ".db3") + ".zstd");
  if (!whole_file()) return;  // nothing is unpacked as a whole
  const fs::path own = folder_.path() / "tmp";
  fs::create_directory(own);
  const char* before = std::getenv("TMPDIR");
  const std::string old = before == nullptr ? "" : before;
  setenv("TMPDIR", own.c_str(), 1);
  const pid_t killed = fork();
  if (killed == 0) {
    const UnpackedFile unpacked(file);
    _exit(0);  // as by a kill: no destructor runs
  }
  int status = 0;
  ASSERT_EQ(waitpid(killed, &status, 0), killed);
  const auto copies = [&] { return std::distance(fs::directory_iterator(own), {}); };
  EXPECT_EQ(copies(), 1);
  {
    const UnpackedFile mine(file);
    EXPECT_EQ(copies(), 1);
    const UnpackedFile other(file);
    EXPECT_EQ(copies(), 2) << "what is in use stays";
    EXPECT_EQ(read_bag(mine.path()).messages, some_messages());
  }
  EXPECT_EQ(copies(), 0);
  old.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", old.c_str(), 1);
}

TEST_P(Packing, LeavesNoUnpackedCopyBehind) {
  const auto copies = [] {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(fs::temp_directory_path())) {
      count += entry.path().filename().string().rfind("strata-unpacked-", 0) == 0 ? 1U : 0U;
    }
    return count;
  };
  const fs::path bag = write(some_messages());
  // Other tests may run beside this one, so the folder for copies is one of its own.
  const fs::path own = folder_.path() / "tmp";
  fs::create_directory(own);
  const char* before = std::getenv("TMPDIR");
  const std::string old = before == nullptr ? "" : before;
  setenv("TMPDIR", own.c_str(), 1);
  EXPECT_EQ(read_bag(bag).messages.size(), some_messages().size());
  EXPECT_EQ(copies(), 0U);
  old.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", old.c_str(), 1);
}

INSTANTIATE_TEST_SUITE_P(
    All, Packing,
    ::testing::Combine(::testing::Values(BagStorage::kSqlite3, BagStorage::kMcap),
                       ::testing::Values(BagPacking::kFile, BagPacking::kMessage)));

class PackedBag : public ::testing::Test {
 protected:
  /// A plain MCAP bag (one file) or SQLite bag whose messages are `pack`ed by the caller.
  fs::path write(const std::string& name, const std::function<Bytes(const Bytes&)>& pack) {
    const fs::path bag = folder_.path() / name;
    BagWriter writer(bag, BagStorage::kSqlite3);
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    for (const auto& [ns, data] : some_messages()) writer.write(topic, {ns}, pack(data));
    writer.close();
    return bag;
  }
  strata::test::TemporaryDirectory folder_;
};

Bytes as_is(const Bytes& data) { return data; }

TEST_F(PackedBag, Lz4ReadsAsWell) {
  const fs::path messages =
      write("messages", [](const Bytes& data) { return compress(data, BagCompression::kLz4); });
  EXPECT_EQ(read_bag(messages).messages, some_messages());
  const fs::path bag = write("files", as_is);
  const std::string plain = bytes_of(bag / "files_0.db3");
  const Bytes packed = compress({reinterpret_cast<const std::uint8_t*>(plain.data()), plain.size()},
                                BagCompression::kLz4);
  fs::remove(bag / "files_0.db3");
  write_text(bag / "files_0.db3.lz4", {packed.begin(), packed.end()});
  EXPECT_EQ(read_bag(bag).messages, some_messages()) << "metadata.yaml names files_0.db3";
}

TEST_F(PackedBag, ACompressionThatIsNotKnownIsRefusedByName) {
  const fs::path bag = write("bag", as_is);
  std::string metadata = bytes_of(bag / "metadata.yaml");
  const auto set = [&](const std::string& key, const std::string& value) {
    const std::string old = key + ": \"\"";
    metadata.replace(metadata.find(old), old.size(), key + ": \"" + value + "\"");
  };
  set("compression_mode", "MESSAGE");
  set("compression_format", "bz2");
  write_text(bag / "metadata.yaml", metadata);
  try {
    (void)BagReader::open(bag);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("bz2"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("metadata.yaml"));
  }
}

TEST_F(PackedBag, ADamagedMessageIsLeftOutAndCounted) {
  std::size_t written = 0;
  const fs::path bag = write("bag", [&](const Bytes& data) {
    Bytes packed = compress(data, BagCompression::kZstd);
    if (++written % 10 == 0) packed.resize(packed.size() / 2);
    return packed;
  });
  const BagContent content = read_bag(bag);
  EXPECT_EQ(content.messages.size(), some_messages().size() - 4);
  EXPECT_EQ(content.damage.count, 4U);
  EXPECT_THAT(content.damage.first, ::testing::HasSubstr("message 10"));
}

TEST_F(PackedBag, APackedFileThatIsCutReadsInPartOrIsRefusedByName) {
  BagOptions options{.storage = BagStorage::kMcap, .packing = BagPacking::kFile};
  const fs::path bag = folder_.path() / "bag";
  {
    BagWriter writer(bag, options);
    const auto topic = writer.add_topic({"/a", "std_msgs/msg/String", "cdr", ""});
    std::uint64_t state = 1;
    for (std::int64_t i = 0; i < 64; ++i) {
      Bytes data(100'000);
      for (auto& byte : data) {
        byte = static_cast<std::uint8_t>((state = state * 6364136223846793005ULL + 1) >> 56);
      }
      writer.write(topic, {i}, data);
    }
  }
  const fs::path file = bag / "bag_0.mcap.zstd";
  const std::string whole = bytes_of(file);
  write_text(file, whole.substr(0, whole.size() / 2));
  const BagContent content = read_bag(bag);
  EXPECT_GT(content.messages.size(), 10U);
  EXPECT_LT(content.messages.size(), 64U);
  EXPECT_THAT(content.damage.first, ::testing::HasSubstr("bag_0.mcap.zstd"));
  write_text(file, whole.substr(0, 30));
  try {
    (void)BagReader::open(bag);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("bag_0.mcap.zstd"));
  }
}

TEST(Compression, AFrameThatSaysLessThanItHoldsIsRefused) {
  const Bytes plain(100'000, 7);
  for (const auto compression : {BagCompression::kZstd, BagCompression::kLz4}) {
    const Bytes packed = compress(plain, compression);
    std::string error;
    EXPECT_EQ(decompress(packed, compression, plain.size(), error), plain);
    EXPECT_EQ(error, "");
    (void)decompress(packed, compression, plain.size() - 1, error);
    EXPECT_NE(error, "");
    (void)decompress(View(packed).first(packed.size() - 1), compression, plain.size(), error);
    EXPECT_NE(error, "");
  }
}

}  // namespace
}  // namespace strata::log
