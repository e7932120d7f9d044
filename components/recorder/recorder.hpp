// SPDX-License-Identifier: Apache-2.0
/// strata::Recorder: topics in, a rosbag2 bag out, message by message as the bytes they came in.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "components/log/bag.hpp"
#include "components/recorder/config.hpp"
#include "components/runtime/component.hpp"

namespace strata::recorder {

/// Reads as the writers that are there offer: reliably when all do, latched messages too;
/// losslessly in lockstep.
class Recorder final : public runtime::Component {
 public:
  using Component::Component;

 private:
  void on_configure() override;
  void on_tick() override;
  void on_deactivate() override;
  void on_cleanup() override;
  void record(const std::string& topic, const bus::PublishedTopic& published);

  RecorderConfig config_;
  std::unique_ptr<log::BagWriter> bag_;
  std::map<std::string, std::size_t> recorded_;  ///< place in the bag by topic
};

}  // namespace strata::recorder
