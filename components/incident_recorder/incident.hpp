// SPDX-License-Identifier: Apache-2.0
/// One incident, written on a thread of its own: a robot does not wait for its disk.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "components/incident_recorder/incident_folder.hpp"
#include "components/incident_recorder/message_ring.hpp"
#include "components/log/bag.hpp"

namespace strata::incident_recorder {

struct IncidentPlan {
  std::filesystem::path incidents;      ///< the folder of all
  std::vector<std::string> keep_files;  ///< of which copies are kept
  std::uint64_t max_disk_bytes = 0;     ///< of all incidents
  std::size_t max_waiting_bytes = 0;    ///< messages that wait for the disk; more are lost
};

/// An MCAP bag, its chunks packed with zstd, and its record. What is written survives the end of
/// the process by whatever cause but for the last second; the record then says that it is not
/// complete. When there is no room, older incidents have gone, and what cannot be written is
/// counted.
class Incident {
 public:
  /// record: what is known as it begins. messages: those before it.
  Incident(IncidentPlan plan, IncidentRecord record, std::vector<KeptMessagePtr> messages);
  /// Completes it.
  ~Incident();
  Incident(const Incident&) = delete;
  Incident& operator=(const Incident&) = delete;

  void add(KeptMessagePtr message);
  /// It goes on for another reason.
  void add(IncidentReason reason);
  /// Nothing more comes; returns at once.
  void end();
  /// Ends it and waits until it is done.
  void finish();
  /// Whether everything is on the disk, or cannot come there.
  [[nodiscard]] bool is_done() const;
  /// What went wrong, since the last call.
  [[nodiscard]] std::vector<std::string> take_problems();
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  void run();
  void write_all();
  void begin(log::BagWriter& bag);
  void write(log::BagWriter& bag, const KeptMessage& message);
  void complete(log::BagWriter& bag);
  void tell(const std::string& problem);

  const IncidentPlan plan_;
  const std::filesystem::path folder_;
  IncidentRecord record_;  // the thread's until it is done, as both below
  std::map<std::string, std::size_t> places_;
  bool is_stuck_ = false;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<IncidentReason> reasons_;  // under mutex_, as all below
  std::deque<KeptMessagePtr> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t lost_ = 0;
  std::vector<std::string> problems_;
  bool ends_ = false;
  bool is_done_ = false;
  std::thread thread_;
};

}  // namespace strata::incident_recorder
