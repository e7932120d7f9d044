// SPDX-License-Identifier: Apache-2.0
#include "components/log/content_hash.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "components/log/sha256.hpp"
#include "core/base/error.hpp"
#include "tests/support/command.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

void write_maps(const fs::path& folder) {
  write(folder / "strata.db", std::string("a\0b", 3));
  write(folder / "patches/submap0.pgm", "P5");
  write(folder / "patches.yaml", "image: patches.pgm");
  write(folder / "summary.json", "{}");
}

class ContentHash : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  test::TemporaryDirectory folder_;
};

// FIPS 180-2, appendix B.1.
TEST_F(ContentHash, BeginsWithTheStandardsOwnExample) {
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

// What docs/site.md tells integrators to run.
TEST_F(ContentHash, IsWhatSha256sumMakesOfTheSameFiles) {
  write_maps(at("maps"));
  const test::Outcome outcome = test::run_command(
      "cd " + test::quoted(at("maps")) +
      " && find . -type f ! -path '*/.*' ! -name '*-wal' ! -name '*-shm' -printf '%P\\n'"
      " | LC_ALL=C sort | xargs -d '\\n' sha256sum | sha256sum");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_EQ(outcome.out.substr(0, 64), hash_content(at("maps")).hash);
}

TEST_F(ContentHash, IsOfWhatIsInTheFolderAndOfNothingElse) {
  write_maps(at("one"));
  write_maps(at("two"));
  fs::last_write_time(at("two") / "strata.db",
                      fs::file_time_type::clock::now() - std::chrono::hours(1000));
  write(at("two") / "strata.db-shm", "who has it open");
  write(at("two") / ".strata.db.partial-7", "not whole yet");
  write(at("two") / ".cache/thumbnail.png", "somebody's");
  EXPECT_EQ(hash_content(at("one")).hash, hash_content(at("two")).hash);
}

TEST_F(ContentHash, ChangesWithABitAndWithAName) {
  write_maps(at("maps"));
  const HashedContent whole = hash_content(at("maps"));
  write(at("maps") / "strata.db", std::string("a\0c", 3));
  const std::string other_bit = hash_content(at("maps")).hash;
  EXPECT_NE(other_bit, whole.hash);
  write_maps(at("maps"));
  EXPECT_EQ(hash_content(at("maps")).hash, whole.hash);
  fs::rename(at("maps") / "summary.json", at("maps") / "summary.jsom");
  EXPECT_NE(hash_content(at("maps")).hash, whole.hash);
}

TEST_F(ContentHash, ListsItsFilesWithTheirSizes) {
  write_maps(at("maps"));
  const HashedContent content = hash_content(at("maps"));
  ASSERT_EQ(content.files.size(), 4U);
  EXPECT_EQ(content.files[0].path, "patches.yaml");
  EXPECT_EQ(content.files[1].path, "patches/submap0.pgm");
  EXPECT_EQ(content.files[2].path, "strata.db");
  EXPECT_EQ(content.files[2].bytes, 3U);
  EXPECT_EQ(content.bytes(), 18U + 2U + 3U + 2U);
  EXPECT_EQ(content.files[3].sha256, sha256_of("{}"));
}

TEST_F(ContentHash, SaysWhatCannotBeRead) {
  EXPECT_THROW((void)hash_content(at("nothing")), InputError);
  write(at("file"), "");
  EXPECT_THROW((void)hash_content(at("file")), InputError);
  EXPECT_THROW((void)hash_file(at("nothing")), InputError);
}

}  // namespace
}  // namespace strata::log
