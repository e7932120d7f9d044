// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag.hpp"

#include <algorithm>
#include <map>
#include <system_error>
#include <utility>

#include "components/log/bag_storage.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

std::unique_ptr<BagReader> open_file(const fs::path& file) {
  if (!fs::exists(file)) throw InputError(file.string(), "does not exist", "check the path");
  if (is_mcap(file)) return open_mcap(file);
  if (is_sqlite(file)) return open_sqlite_bag(file);
  throw InputError(file.string(), "is neither an SQLite nor an MCAP bag",
                   "check that it was copied whole");
}

/// The files of a split bag one after the other, as one.
class BagFolder : public BagReader {
 public:
  explicit BagFolder(const std::vector<fs::path>& files) {
    std::exception_ptr first_error;
    for (const fs::path& file : files) {
      try {
        parts_.push_back({open_file(file), {}});
      } catch (const InputError& error) {
        if (!first_error) first_error = std::current_exception();
        damage_.add(error.what());
      }
    }
    if (parts_.empty()) std::rethrow_exception(first_error);
    for (Part& part : parts_) map_topics(part);
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const BagDamage& damage() const override { return damage_; }
  bool next(BagMessage& message) override {
    while (current_ < parts_.size()) {
      Part& part = parts_[current_];
      if (part.reader->next(message)) {
        map_topics(part);
        message.topic = part.topics[message.topic];
        return true;
      }
      const BagDamage& damage = part.reader->damage();
      if (damage.count > 0) {
        if (damage_.count == 0) damage_.first = damage.first;
        damage_.count += damage.count;
      }
      ++current_;
    }
    return false;
  }

 private:
  struct Part {
    std::unique_ptr<BagReader> reader;
    std::vector<std::size_t> topics;  ///< place in ours
  };
  void map_topics(Part& part) {
    const auto& theirs = part.reader->topics();
    while (part.topics.size() < theirs.size()) {
      const BagTopic& topic = theirs[part.topics.size()];
      const auto found = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& known) {
        return known.name == topic.name && known.type == topic.type;
      });
      part.topics.push_back(static_cast<std::size_t>(found - topics_.begin()));
      if (found == topics_.end()) topics_.push_back(topic);
    }
  }

  std::vector<Part> parts_;
  std::size_t current_ = 0;
  std::vector<BagTopic> topics_;
  BagDamage damage_;
};

}  // namespace

std::unique_ptr<BagReader> BagReader::open(const fs::path& path) {
  if (fs::is_directory(path)) return std::make_unique<BagFolder>(bag_files(path));
  return open_file(path);
}

struct BagWriter::State {
  fs::path folder;
  BagSummary summary;
  std::map<std::string, std::size_t> places;
  std::unique_ptr<File> file;
  bool any = false;
  bool closed = false;
};

BagWriter::BagWriter(const fs::path& folder, BagStorage storage, BagCompression compression)
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
  state_->summary.storage = storage;
  fs::path stem = fs::weakly_canonical(fs::absolute(folder));
  if (!stem.has_filename()) stem = stem.parent_path();
  const bool mcap = storage == BagStorage::kMcap;
  std::string name = stem.filename().string();
  while (!name.empty() && name.front() == '.') name.erase(0, 1);  // written aside, see log_writer
  name = name.substr(0, name.find(".partial-"));
  state_->summary.file = (name.empty() ? "bag" : name) + "_0" + (mcap ? ".mcap" : ".db3");
  const fs::path file = folder / state_->summary.file;
  state_->file = mcap ? create_mcap(file, compression) : create_sqlite_bag(file);
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
    state.file->add_topic(topic);
  }
  return entry->second;
}

void BagWriter::write(std::size_t topic, Stamp stamp, std::span<const std::uint8_t> cdr) {
  State& state = *state_;
  state.file->write(topic, stamp, cdr);
  ++state.summary.counts.at(topic);
  state.summary.begin = state.any ? std::min(state.summary.begin, stamp) : stamp;
  state.summary.end = state.any ? std::max(state.summary.end, stamp) : stamp;
  state.any = true;
}

void BagWriter::close() {
  if (state_->closed) return;
  state_->closed = true;
  state_->file->close();
  write_bag_metadata(state_->folder, state_->summary);
}

}  // namespace strata::log
