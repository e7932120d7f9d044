// SPDX-License-Identifier: Apache-2.0
#include <exception>
#include <system_error>
#include <utility>

#include "components/log/bag.hpp"
#include "components/log/bag_writer_state.hpp"
#include "components/log/folder_name.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

/// What may wait while nothing can be written.
constexpr std::size_t kMaxWaitingBytes = 1U << 20U;
constexpr auto kRetryPeriod = std::chrono::milliseconds(500);

}  // namespace

void require_new_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && (!fs::is_directory(folder) || !fs::is_empty(folder))) {
    throw OutputError(folder.string(), "exists already", "choose another name or remove it");
  }
}

BagWriter::BagWriter(const fs::path& folder, const BagOptions& options)
    : state_(std::make_unique<State>()) {
  require_new_folder(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw OutputError(folder.string(), "cannot be made: " + error.message(),
                      "check the permissions of its parent");
  }
  state_->folder = folder;
  state_->options = options;
  state_->summary.storage = options.storage;
  state_->summary.sqlite_schema = options.sqlite_schema;
  state_->summary.packing = options.packing;
  const fs::path stem = without_slash(fs::weakly_canonical(fs::absolute(folder)));
  // A folder that is written aside is called .NAME.partial-PID until it is whole.
  std::string name = stem.filename().string();
  if (const auto partial = name.find(".partial-");
      partial != std::string::npos && name.front() == '.') {
    name = name.substr(1, partial - 1);
  }
  state_->name = name.empty() ? "bag" : name;
  state_->open_file();
}

BagWriter::~BagWriter() {
  try {
    close();
  } catch (const std::exception&) {  // a destructor cannot report; `close` can
  }
}

std::size_t BagWriter::add_topic(const BagTopic& topic) {
  State& state = *state_;
  const auto [entry, is_new] = state.places.try_emplace(topic.name, state.summary.topics.size());
  const std::size_t place = entry->second;
  if (is_new) {
    state.summary.topics.push_back(topic);
    state.summary.counts.push_back(0);
    try {
      if (state.file && !state.failed) state.attempt([&] { state.file->add_topic(topic); });
    } catch (const std::exception&) {
      state.untold = std::current_exception();
    }
  }
  return place;
}

void BagWriter::write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr, Stamp at) {
  State& state = *state_;
  if (state.options.storage == BagStorage::kMcap && stamp.ns < 0) {
    throw OutputError(state.folder.string(), "MCAP has no stamps before 1970",
                      "write SQLite or shift the stamps");
  }
  if (state.closed) {
    // It names the files up to now only; who finds none reads them all, after a kill too.
    fs::remove(state.folder / "metadata.yaml");
    state.closed = false;
  }
  if (state.failed && State::Clock::now() - state.tried >= kRetryPeriod) {
    try {
      state.attempt([&] { state.go_on(); });
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): it was told before
    }
  }
  if (state.failed && state.waiting_bytes + cdr.size() > kMaxWaitingBytes) {
    ++state.lost;
    throw OutputError(state.folder.string(), "a message is lost: no file can be written",
                      "free some space; the recording goes on then");
  }
  const bool packs = state.options.packing == BagPacking::kMessage;
  state.wait({topic, stamp,
              packs ? compress(cdr, BagCompression::kZstd) : Bytes(cdr.begin(), cdr.end()),
              cdr.size(), at});
  if (state.untold) std::rethrow_exception(std::exchange(state.untold, nullptr));
  if (state.failed) return;
  state.attempt([&] {
    if (!state.file) state.open_file();  // the last one was closed
    state.hand_over();
  });
}

void BagWriter::flush() {
  State& state = *state_;
  state.attempt([&] {
    if (state.failed) {
      state.go_on();
    } else if (state.file) {
      state.file->flush();
      state.settle();
    }
  });
}

void BagWriter::close() {
  State& state = *state_;
  if (state.closed) return;
  state.attempt([&] {
    if (state.failed) state.go_on();
    state.close_file();
  });
  write_bag_metadata(state.folder, state.summary);
  state.closed = true;
}

BagGap BagWriter::gap() const { return {state_->lost, state_->failed}; }

}  // namespace strata::log
