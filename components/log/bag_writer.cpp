// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <system_error>
#include <utility>

#include "components/convert/message_definitions.hpp"
#include "components/convert/type_hash.hpp"
#include "components/log/bag.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/compression.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {

struct BagWriter::State {
  fs::path folder;
  std::string name;  ///< of the bag, and what its files begin with
  BagOptions options;
  BagSummary summary;
  std::map<std::string, std::size_t> places;
  std::unique_ptr<File> file;
  std::uint64_t file_bytes = 0;
  bool closed = false;

  /// Begins the next storage file, with every topic known so far.
  void open_file() {
    const bool mcap = options.storage == BagStorage::kMcap;
    const std::string file_name =
        name + "_" + std::to_string(summary.files.size()) + (mcap ? ".mcap" : ".db3");
    const fs::path path = folder / file_name;
    file =
        mcap ? create_mcap(path, options.chunks) : create_sqlite_bag(path, options.sqlite_schema);
    file_bytes = 0;
    summary.files.push_back({file_name, {}, {}, 0});
    for (const BagTopic& topic : summary.topics) file->add_topic(topic);
  }

  void close_file() {
    if (!file) return;  // the next could not be made
    file->close(bag_information(summary));
    file.reset();
    if (options.packing != BagPacking::kFile) return;
    std::string& file_name = summary.files.back().name;
    const fs::path plain = folder / file_name;
    file_name += ".zstd";
    pack_file(plain, folder / file_name);
    fs::remove(plain);
  }

  [[nodiscard]] bool is_full(Stamp stamp) const {
    const BagSummary::File& current = summary.files.back();
    if (current.messages == 0) return false;
    return (options.split_bytes > 0 && file_bytes >= options.split_bytes) ||
           (options.split_after.ns > 0 && stamp - current.begin >= options.split_after);
  }
};

TypeDefinition definition_of(const BagTopic& topic) {
  if (!topic.definition.empty()) return {topic.definition_encoding, topic.definition};
  return {"ros2msg", convert::message_definition(topic.type)};
}

std::string type_hash_of(const BagTopic& topic) {
  return topic.type_hash.empty() ? convert::type_hash(topic.type) : topic.type_hash;
}

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
  if (is_new) {
    state.summary.topics.push_back(topic);
    state.summary.counts.push_back(0);
    if (state.file) state.file->add_topic(topic);
  }
  return entry->second;
}

void BagWriter::write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr) {
  State& state = *state_;
  if (state.closed) {
    // It names the files up to now only; who finds none reads them all, after a kill too.
    fs::remove(state.folder / "metadata.yaml");
    state.open_file();
    state.closed = false;
  } else if (!state.file || state.is_full(stamp)) {
    state.close_file();
    state.open_file();
  }
  if (state.options.packing == BagPacking::kMessage) {
    state.file->write(topic, stamp, compress(cdr, BagCompression::kZstd));
  } else {
    state.file->write(topic, stamp, cdr);
  }
  state.file_bytes += cdr.size();
  ++state.summary.counts.at(topic);
  BagSummary::File& file = state.summary.files.back();
  file.begin = file.messages > 0 ? std::min(file.begin, stamp) : stamp;
  file.end = file.messages > 0 ? std::max(file.end, stamp) : stamp;
  ++file.messages;
}

void BagWriter::flush() {
  if (state_->file) state_->file->flush();
}

void BagWriter::close() {
  if (state_->closed) return;
  state_->closed = true;
  state_->close_file();
  write_bag_metadata(state_->folder, state_->summary);
}

}  // namespace strata::log
