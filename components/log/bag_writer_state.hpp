// SPDX-License-Identifier: Apache-2.0
/// What a BagWriter does with its files: begins, fills, gives up, goes on.
#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "components/log/bag.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/compression.hpp"
#include "core/base/error.hpp"

namespace strata::log {

struct BagWriter::State {
  using Clock = std::chrono::steady_clock;

  struct Waiting {
    std::size_t topic = 0;
    Stamp stamp;
    Bytes data;
    std::size_t plain_bytes = 0;
    Stamp at;  ///< when it came, for splits
  };

  std::filesystem::path folder;
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
  Stamp file_begin;         ///< by when its messages came
  std::size_t settled = 0;  ///< messages that the summary counts

  std::deque<Waiting> waiting;  ///< not saved yet
  std::size_t handed_over = 0;  ///< of these, from the first
  std::size_t waiting_bytes = 0;

  /// Begins the next storage file, with every topic known so far.
  void open_file() {
    const bool mcap = options.storage == BagStorage::kMcap;
    const std::string file_name =
        name + "_" + std::to_string(summary.files.size()) + (mcap ? ".mcap" : ".db3");
    const std::filesystem::path path = folder / file_name;
    if (std::filesystem::exists(path))
      throw OutputError(path.string(), "is in the way", "remove it");
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
    const std::filesystem::path plain = folder / file_name;
    pack_file(plain, folder / (file_name + ".zstd"));
    file_name += ".zstd";
    std::filesystem::remove(plain);
  }

  [[nodiscard]] bool is_full(Stamp at) const {
    if (file_messages == 0) return false;
    return (options.split_bytes > 0 && file_bytes >= options.split_bytes) ||
           (options.split_after.ns > 0 && at - file_begin >= options.split_after);
  }

  void wait(Waiting message) {
    waiting_bytes += message.data.size();
    waiting.push_back(std::move(message));
  }

  /// Gives the file what waits.
  void hand_over() {
    while (handed_over < waiting.size()) {
      if (is_full(waiting[handed_over].at)) {
        close_file();
        open_file();
      }
      const Waiting& next = waiting[handed_over];
      file->write(next.topic, next.stamp, next.data);
      file_begin = file_messages > 0 ? std::min(file_begin, next.at) : next.at;
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

  static void remove_storage(const std::filesystem::path& file) {
    std::error_code ignored;
    for (const char* side : {"", "-wal", "-shm", "-journal"}) {
      std::filesystem::remove(file.string() + side, ignored);
    }
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

}  // namespace strata::log
