// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/incident.hpp"

#include <chrono>
#include <exception>
#include <utility>

#include "core/base/error.hpp"

namespace strata::incident_recorder {
namespace {

constexpr auto kFlushPeriod = std::chrono::milliseconds(500);

}  // namespace

Incident::Incident(IncidentPlan plan, IncidentRecord record, std::vector<KeptMessagePtr> messages)
    : plan_(std::move(plan)),
      folder_(record.folder),
      record_(std::move(record)),
      reasons_(record_.reasons),
      waiting_(messages.begin(), messages.end()),
      thread_([this] { run(); }) {}

Incident::~Incident() { finish(); }

void Incident::finish() {
  end();
  if (thread_.joinable()) thread_.join();
}

void Incident::add(KeptMessagePtr message) {
  const std::lock_guard lock(mutex_);
  if (ends_) return;
  if (waiting_bytes_ + message->cdr.size() > plan_.max_waiting_bytes) {
    ++lost_;
    return;
  }
  waiting_bytes_ += message->cdr.size();
  waiting_.push_back(std::move(message));
  changed_.notify_one();
}

void Incident::add(IncidentReason reason) {
  const std::lock_guard lock(mutex_);
  reasons_.push_back(std::move(reason));
}

void Incident::end() {
  const std::lock_guard lock(mutex_);
  ends_ = true;
  changed_.notify_one();
}

bool Incident::is_done() const {
  const std::lock_guard lock(mutex_);
  return is_done_;
}

std::vector<std::string> Incident::take_problems() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problems_, {});
}

void Incident::tell(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  problems_.push_back(problem);
}

void Incident::run() {
  try {
    write_all();
  } catch (const std::exception& error) {
    tell(error.what());
  }
  const std::lock_guard lock(mutex_);
  waiting_.clear();
  ends_ = true;
  is_done_ = true;
}

void Incident::write_all() {
  log::BagOptions options;
  options.storage = log::BagStorage::kMcap;
  options.chunks = log::BagCompression::kZstd;
  log::BagWriter bag(record_.folder, options);
  begin(bag);
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kFlushPeriod, [this] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty() && ends_) break;
    const std::deque<KeptMessagePtr> batch = std::exchange(waiting_, {});
    waiting_bytes_ = 0;
    lock.unlock();
    for (const KeptMessagePtr& message : batch) write(bag, *message);
    try {
      bag.flush();
    } catch (const OutputError&) {  // NOLINT(bugprone-empty-catch): the gap is told at the end
    }
  }
  complete(bag);
}

/// The record comes first: a process that is killed from here on leaves an incident that is listed,
/// and its files are kept for it.
void Incident::begin(log::BagWriter& bag) {
  write_record(record_);
  try {
    bag.flush();
    (void)make_room(plan_.incidents, plan_.max_disk_bytes);
    std::vector<std::string> problems;
    record_.files = keep_files(plan_.incidents, plan_.keep_files, problems);
    for (const std::string& problem : problems) {
      tell(folder_.string() + ": keeps no copy of " + problem + "; see keep_files");
    }
    if (!record_.files.empty()) write_record(record_);
  } catch (const std::exception& error) {
    tell(error.what());
  }
}

void Incident::write(log::BagWriter& bag, const KeptMessage& message) {
  const KeptTopic& topic = *message.topic;
  const auto [place, is_new] = places_.try_emplace(topic.name, 0);
  if (is_new) {
    log::BagTopic entry{topic.name, topic.type, "cdr", topic.offered_qos};
    entry.type_hash = topic.type_hash;
    place->second = bag.add_topic(entry);
  }
  try {
    bag.write(place->second, message.stamp, message.cdr);
    ++record_.messages;
  } catch (const OutputError& error) {
    if (!std::exchange(is_stuck_, true)) tell(error.what());
  }
}

void Incident::complete(log::BagWriter& bag) {
  bag.close();
  record_.lost = bag.gap().lost;
  {
    const std::lock_guard lock(mutex_);
    record_.lost += lost_;
    record_.reasons = reasons_;
  }
  record_.is_complete = true;
  write_record(record_);
  (void)make_room(plan_.incidents, plan_.max_disk_bytes);
}

}  // namespace strata::incident_recorder
