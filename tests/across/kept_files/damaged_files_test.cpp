// SPDX-License-Identifier: Apache-2.0
/// No component is kept from its work by a damaged file of its own, and none destroys it.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/grid/reflection_grid.hpp"
#include "memory/store/store.hpp"
#include "tests/across/kept_files/kept_file.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/components/runtime/status_watch.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void write(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

/// What no reader can take for the whole file.
std::vector<std::pair<std::string, std::string>> ruins(const std::string& whole) {
  std::mt19937 random(7);
  std::string noise(whole.size(), '\0');
  for (char& byte : noise) byte = static_cast<char>(random() & 0xFFU);
  return {{"empty", ""},
          {"its first bytes", whole.substr(0, 10)},
          {"a quarter", whole.substr(0, whole.size() / 4)},
          {"a half", whole.substr(0, whole.size() / 2)},
          {"zeros", std::string(whole.size(), '\0')},
          {"noise", noise}};
}

class DamagedFileOf : public ::testing::TestWithParam<test::KeptFile> {
 protected:
  DamagedFileOf() {
    GetParam().write(file_);
    whole_ = test::bytes_of(file_);
  }
  [[nodiscard]] fs::path beside(const std::string& ending) const { return file_.string() + ending; }
  /// A life of the component that is configured and active.
  [[nodiscard]] std::unique_ptr<runtime::Host> begin(const std::string& more = "") const {
    auto host =
        test::make_host(GetParam().entry(file_, more), test::keepers(), test::make_participant());
    host->activate();
    return host;
  }

  void configure(const runtime::HostOptions& options) const {
    const std::string text =
        "processes: [{name: p, components: [" + GetParam().entry(file_) + "]}]";
    const auto composition =
        runtime::read_composition(settings::parse_yaml(text, "test.yaml"), "test.yaml");
    const runtime::Host host(composition, composition.processes[0], test::keepers(),
                             test::make_participant(), options);
  }
  /// Live and where it is only looked at.
  void expect_refused() const {
    const std::string bytes = test::bytes_of(file_);
    const auto is_told = AllOf(HasSubstr(file_.string() + ": is another file than"),
                               HasSubstr("name another file in "), HasSubstr("store"));
    for (const bool dry_run : {false, true}) {
      try {
        configure({.dry_run = dry_run});
        ADD_FAILURE() << "it began";
      } catch (const ConfigError& error) {
        EXPECT_THAT(error.what(), is_told);
      }
    }
    EXPECT_EQ(test::bytes_of(file_), bytes);
    EXPECT_FALSE(fs::exists(beside(".damaged")));
  }

  test::TemporaryDirectory folder_;
  fs::path file_ = folder_.path() / GetParam().name;
  std::string whole_;
};

TEST_P(DamagedFileOf, IsSetAsideByteForByteAndNamedAndTheComponentBegins) {
  int number = 0;
  for (const auto& [what, bytes] : ruins(whole_)) {
    SCOPED_TRACE(what);
    write(file_, bytes);
    const auto host = begin();
    EXPECT_EQ(host->components().front()->state(), runtime::LifecycleState::kActive);
    const std::string aside =
        file_.string() + ".damaged" + (++number > 1 ? "-" + std::to_string(number) : "");
    EXPECT_THAT(host->take_errors(), Contains(AllOf(HasSubstr("/keeper"), HasSubstr(aside))));
    EXPECT_EQ(test::bytes_of(aside), bytes);
  }
  // None has taken the place of another.
  number = 0;
  for (const auto& [what, bytes] : ruins(whole_)) {
    EXPECT_EQ(
        test::bytes_of(beside(".damaged" + (++number > 1 ? "-" + std::to_string(number) : ""))),
        bytes)
        << what;
  }
  const auto host = begin();
  EXPECT_THAT(host->take_errors(), IsEmpty()) << "what a new life kept is whole";
}

TEST_P(DamagedFileOf, IsWarnedOfOnDiagnosticsAndRosoutUntilTheNextLife) {
  write(file_, whole_.substr(0, whole_.size() / 2));
  const auto participant = test::make_participant();
  test::Collector<rcl_interfaces::msg::Log> logs(participant, "/rosout", "rosout");
  test::StatusWatch watch(participant);
  const auto host = begin();
  const std::string aside = beside(".damaged").string();
  const auto is_told = [&](const auto& status) {
    return status.message().find(aside) != std::string::npos;
  };
  const auto status = watch.wait_for(*host, is_told);
  EXPECT_TRUE(is_told(status));
  EXPECT_EQ(status.level(), static_cast<std::uint8_t>(runtime::HealthLevel::kWarn));
  std::vector<rcl_interfaces::msg::Log> warnings;
  for (std::size_t seen = 1; warnings.empty(); ++seen) {
    const auto all = logs.wait_for(seen);
    ASSERT_GE(all.size(), seen) << "no warning came";
    if (all[seen - 1].level() == 30) warnings.push_back(all[seen - 1]);
  }
  EXPECT_THAT(warnings.front().msg(), HasSubstr(aside));
  runtime::Component& component = *host->components().front();
  component.deactivate();
  component.cleanup();
  component.configure();
  component.activate();
  const auto after = watch.wait_for(*host, [&](const auto& now) { return !is_told(now); });
  EXPECT_NE(after.level(), static_cast<std::uint8_t>(runtime::HealthLevel::kError));
  EXPECT_FALSE(is_told(after));
}

// A bit that no checksum covers may be taken for what was written; but nothing is refused or lost.
TEST_P(DamagedFileOf, WithAFlippedBitKeepsNoComponentFromItsWork) {
  for (const double place : {0.3, 0.5, 0.7, 0.9}) {
    SCOPED_TRACE(place);
    std::string bytes = whole_;
    const auto at = static_cast<std::size_t>(place * static_cast<double>(bytes.size()));
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    write(file_, bytes);
    const auto host = begin();
    EXPECT_EQ(host->components().front()->state(), runtime::LifecycleState::kActive);
    if (!fs::exists(beside(".damaged"))) continue;
    EXPECT_EQ(test::bytes_of(beside(".damaged")), bytes);
    fs::remove(beside(".damaged"));
  }
}

TEST_P(DamagedFileOf, ThatIsWholeIsNeitherMovedNorWarnedOf) {
  {
    const auto host = begin();
    EXPECT_THAT(host->take_errors(), IsEmpty());
  }
  EXPECT_FALSE(fs::exists(beside(".damaged")));
  if (GetParam().other_settings.empty()) return;
  EXPECT_THROW((void)begin(GetParam().other_settings), Error);
  EXPECT_FALSE(fs::exists(beside(".damaged")));
  EXPECT_TRUE(fs::exists(file_));
}

TEST_P(DamagedFileOf, StaysWhereItIsWhenItIsOnlyLookedAt) {
  const std::string bytes = whole_.substr(0, whole_.size() / 2);
  write(file_, bytes);
  configure({.dry_run = true});
  EXPECT_EQ(test::bytes_of(file_), bytes);
  EXPECT_FALSE(fs::exists(beside(".damaged")));
}

TEST_P(DamagedFileOf, IsNotTouchedWhenItCannotBeSetAside) {
  // Names may have 255 bytes: there is room for what SQLite keeps beside it, and no more.
  file_ = folder_.path() / std::string(250, 'n');
  const std::string bytes = whole_.substr(0, whole_.size() / 2);
  write(file_, bytes);
  try {
    (void)begin();
    FAIL() << "it began";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(file_.string()), HasSubstr("cannot be set aside")));
  }
  EXPECT_EQ(test::bytes_of(file_), bytes);
}

// A slip in a composition, not damage: another component's file, or the store of a maps folder.
TEST_P(DamagedFileOf, ThatIsAnothersIsRefusedByTheSettingAndLeftAsItIs) {
  const bool keeps_store = GetParam().name.ends_with(".db");
  for (const test::KeptFile& other : test::kept_files()) {
    // Stores of several kinds may share a file, but for a mapper's way.
    const bool may_share =
        keeps_store && other.name.ends_with(".db") && GetParam().component != "TopologyMapper";
    if (other.component == GetParam().component || may_share) continue;
    SCOPED_TRACE(other.component);
    fs::remove(file_);
    other.write(file_);
    expect_refused();
  }
  if (GetParam().component == "TimescaleMemory") return;  // goes on in the memory that was learned
  fs::remove(file_);
  memory::Store(file_).save_grid("filtered", make_reflection_grid(0.05, {{0, 0}, {4, 4}}));
  expect_refused();
}

INSTANTIATE_TEST_SUITE_P(Components, DamagedFileOf, ::testing::ValuesIn(test::kept_files()),
                         [](const auto& test) { return test.param.component; });

/// Those that are stores.
class DamagedStoreOf : public DamagedFileOf {};

TEST_P(DamagedStoreOf, TakesAlongWhatACrashLeftInTheLog) {
  {
    memory::Store store(file_);
    store.save_text("in the log", std::string(20'000, 'x'));
    fs::copy(file_, beside(".crashed"));
    fs::copy(beside("-wal"), beside(".crashed-wal"));
  }
  const std::string bytes = test::bytes_of(beside(".crashed")).substr(0, 3000);
  const std::string log = test::bytes_of(beside(".crashed-wal"));
  ASSERT_GT(log.size(), 0U);
  write(file_, bytes);
  fs::rename(beside(".crashed-wal"), beside("-wal"));
  const auto host = begin();
  // The log alone may hold all that the file lacks.
  if (!fs::exists(beside(".damaged"))) return;
  EXPECT_EQ(test::bytes_of(beside(".damaged")), bytes);
  EXPECT_EQ(test::bytes_of(beside(".damaged-wal")), log);
}

TEST_P(DamagedStoreOf, OfANewerVersionIsRefusedAndLeftAlone) {
  std::string bytes = whole_;
  bytes[63] = 99;  // the low byte of user_version
  write(file_, bytes);
  EXPECT_THROW((void)begin(), InputError);
  EXPECT_EQ(test::bytes_of(file_), bytes);
  EXPECT_FALSE(fs::exists(beside(".damaged")));
}

std::vector<test::KeptFile> stores() {
  std::vector<test::KeptFile> result;
  for (const test::KeptFile& kept : test::kept_files()) {
    if (kept.name.ends_with(".db")) result.push_back(kept);
  }
  return result;
}

INSTANTIATE_TEST_SUITE_P(Components, DamagedStoreOf, ::testing::ValuesIn(stores()),
                         [](const auto& test) { return test.param.component; });

}  // namespace
}  // namespace strata
