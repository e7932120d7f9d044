// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <map>
#include <system_error>
#include <utility>

#include "components/log/bag.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/compression.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {

namespace {

using Clock = std::chrono::steady_clock;

/// What may wait while nothing can be written.
constexpr std::size_t kMostWaitingBytes = 1U << 20U;
constexpr auto kRetryPeriod = std::chrono::milliseconds(500);

struct Waiting {
  std::size_t topic = 0;
  Stamp stamp;
  Bytes data;
  std::size_t plain_bytes = 0;
};

void remove_storage(const fs::path& file) {
  std::error_code ignored;
  for (const char* side : {"", "-wal", "-shm", "-journal"}) {
    fs::remove(file.string() + side, ignored);
  }
}

}  // namespace

struct BagWriter::State {
  fs::path folder;
  std::string name;  ///< of the bag, and what its files begin with
  BagOptions options;
  BagSummary summary;  ///< of what is saved
  std::map<std::string, std::size_t> places;
  std::unique_ptr<File> file;  ///< null: the next message begins another
  /// Given up: what is in them is safe, their ends could not be written yet.
  std::vector<std::unique_ptr<File>> unfinished;
  bool closed = false;
  bool failed = false;        ///< no file can be written
  std::exception_ptr untold;  ///< why, when a topic could not be added
  std::size_t lost = 0;
  Clock::time_point tried;

  // Of the file.
  std::uint64_t file_bytes = 0;
  std::size_t file_messages = 0;
  Stamp file_begin;
  std::size_t settled = 0;  ///< messages that the summary counts

  std::deque<Waiting> waiting;  ///< not saved yet
  std::size_t handed_over = 0;  ///< of these, from the first
  std::size_t waiting_bytes = 0;

  /// Begins the next storage file, with every topic known so far.
  void open_file() {
    const bool mcap = options.storage == BagStorage::kMcap;
    const std::string file_name =
        name + "_" + std::to_string(summary.files.size()) + (mcap ? ".mcap" : ".db3");
    const fs::path path = folder / file_name;
    if (fs::exists(path)) throw OutputError(path.string(), "is in the way", "remove it");
    try {
      file =
          mcap ? create_mcap(path, options.chunks) : create_sqlite_bag(path, options.sqlite_schema);
      for (const BagTopic& topic : summary.topics) file->add_topic(topic);
    } catch (...) {
      file.reset();
      remove_storage(path);
      throw;
    }
    file_bytes = 0;
    file_messages = 0;
    settled = 0;
    summary.files.push_back({file_name, {}, {}, 0});
  }

  void close_file() {
    if (!file) return;  // the next could not be made
    file->flush();
    settle();
    file->close(bag_information(summary));
    file.reset();
    if (options.packing == BagPacking::kFile) pack();
  }

  void pack() {
    std::string& file_name = summary.files.back().name;
    const fs::path plain = folder / file_name;
    pack_file(plain, folder / (file_name + ".zstd"));
    file_name += ".zstd";
    fs::remove(plain);
  }

  [[nodiscard]] bool is_full(Stamp stamp) const {
    if (file_messages == 0) return false;
    return (options.split_bytes > 0 && file_bytes >= options.split_bytes) ||
           (options.split_after.ns > 0 && stamp - file_begin >= options.split_after);
  }

  void wait(Waiting message) {
    waiting_bytes += message.data.size();
    waiting.push_back(std::move(message));
  }

  /// Gives the file what waits.
  void hand_over() {
    while (handed_over < waiting.size()) {
      if (is_full(waiting[handed_over].stamp)) {
        close_file();
        open_file();
      }
      const Waiting& next = waiting[handed_over];
      file->write(next.topic, next.stamp, next.data);
      file_begin = file_messages > 0 ? std::min(file_begin, next.stamp) : next.stamp;
      ++file_messages;
      file_bytes += next.plain_bytes;
      ++handed_over;
      settle();
    }
  }

  /// Counts what is saved.
  void settle() {
    BagSummary::File& counted = summary.files.back();
    for (; settled < file->saved(); ++settled) {
      const Waiting& saved = waiting.front();
      ++summary.counts.at(saved.topic);
      counted.begin = counted.messages > 0 ? std::min(counted.begin, saved.stamp) : saved.stamp;
      counted.end = counted.messages > 0 ? std::max(counted.end, saved.stamp) : saved.stamp;
      ++counted.messages;
      waiting_bytes -= saved.data.size();
      waiting.pop_front();
      if (handed_over > 0) --handed_over;  // none where a write failed only afterwards
    }
  }

  /// The file takes no more; what it did not save waits for another.
  void give_up() {
    failed = true;
    tried = Clock::now();
    if (!file) return;
    file->give_up();
    settle();
    handed_over = 0;
    if (summary.files.back().messages > 0) {
      unfinished.push_back(std::move(file));
      return;
    }
    file.reset();
    remove_storage(folder / summary.files.back().name);
    summary.files.pop_back();
  }

  /// The bag after a failure: the end of what was given up, and another file for what waits.
  void go_on() {
    tried = Clock::now();
    std::exception_ptr problem;
    std::erase_if(unfinished, [&](const std::unique_ptr<File>& old) {
      try {
        old->close(bag_information(summary));
        return true;
      } catch (const Error&) {
        problem = std::current_exception();
        return false;
      }
    });
    if (waiting.empty()) {
      if (problem) std::rethrow_exception(problem);
    } else {  // nothing else keeps it from going on: a file can be read without its end
      open_file();
      hand_over();
      file->flush();
      settle();
    }
    failed = false;
    untold = nullptr;
  }

  /// Runs what writes; a failure ends the file.
  template <typename Body>
  void attempt(const Body& body) {
    try {
      body();
    } catch (...) {
      give_up();
      throw;
    }
  }
};

BagWriter::BagWriter(const fs::path& folder, const BagOptions& options)
    : state_(std::make_unique<State>()) {
  std::error_code error;
  if (fs::exists(folder, error) && (!fs::is_directory(folder) || !fs::is_empty(folder))) {
    throw OutputError(folder.string(), "exists already", "choose another name or remove it");
  }
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
  fs::path stem = fs::weakly_canonical(fs::absolute(folder));
  if (!stem.has_filename()) stem = stem.parent_path();
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

void BagWriter::write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr) {
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
  if (state.failed && Clock::now() - state.tried >= kRetryPeriod) {
    try {
      state.attempt([&] { state.go_on(); });
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): it was told before
    }
  }
  if (state.failed && state.waiting_bytes + cdr.size() > kMostWaitingBytes) {
    ++state.lost;
    throw OutputError(state.folder.string(), "a message is lost: no file can be written",
                      "free some space; the recording goes on then");
  }
  const bool packs = state.options.packing == BagPacking::kMessage;
  state.wait({topic, stamp,
              packs ? compress(cdr, BagCompression::kZstd) : Bytes(cdr.begin(), cdr.end()),
              cdr.size()});
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
