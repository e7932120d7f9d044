// SPDX-License-Identifier: Apache-2.0
/// What somebody else on the domain can send to a replay: bytes on the topics of its steps and
/// answers that are none.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "components/bus/participant_state.hpp"
#include "components/bus/raw_type.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/lockstep_coordinator.hpp"
#include "core/base/error.hpp"
#include "tests/across/every_component/mutator.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/filter_composition.hpp"

namespace strata::tools {
namespace {

using strata_msgs::msg::Ack;
using strata_msgs::msg::Step;
using Bytes = std::vector<std::uint8_t>;

/// Any bytes, also those too few for a header, which our own writer refuses.
class AnyBytes final : public bus::RawType {
 public:
  using RawType::RawType;
  bool serialize(void* data, Payload* payload) override {
    const Bytes& bytes = *static_cast<const Bytes*>(data);
    if (bytes.size() > payload->max_size) return false;
    if (!bytes.empty()) std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    return true;
  }
};

/// Publishes them, reliably, as a participant of its own.
class Stranger {
 public:
  Stranger(const std::string& topic, const std::string& type) {
    namespace dds = bus::dds;
    bus::Participant::State& state = participant_->state();
    const std::string type_name = bus::wire_type(type);
    state.participant->register_type(dds::TypeSupport(new AnyBytes(type_name)));
    dds::Topic* made = state.participant->create_topic(bus::wire_topic(bus::TopicName(topic)),
                                                       type_name, dds::TOPIC_QOS_DEFAULT);
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    qos.endpoint().history_memory_policy = bus::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    qos.data_sharing().off();
    writer_ = state.publisher->create_datawriter(made, qos);
  }
  [[nodiscard]] bool is_heard() const {
    return test::comes_true([&] {
      bus::dds::PublicationMatchedStatus status;
      writer_->get_publication_matched_status(status);
      return status.current_count > 0;
    });
  }
  void send(Bytes bytes) { EXPECT_TRUE(writer_->write(&bytes)) << bytes.size() << " bytes"; }
  [[nodiscard]] bool is_delivered() {
    return writer_->wait_for_acknowledgments({20, 0}) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
  }

 private:
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  bus::dds::DataWriter* writer_ = nullptr;  // the participant's
};

/// A part of a header, cut anywhere, random, long, and of lengths that are not there.
std::vector<Bytes> no_messages(const Bytes& good) {
  std::vector<Bytes> all = {{0}, {0, 1}, {0, 1, 0}};
  for (std::size_t size = 4; size < good.size(); ++size) {
    all.emplace_back(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
  }
  test::Mutator mutator(7);
  for (int i = 0; i < 300; ++i) all.push_back(mutator.mutate(good));
  Bytes much(16U << 20U, 0xFF);
  std::copy_n(good.begin(), 4, much.begin());
  all.push_back(much);
  std::copy(good.begin(), good.end(), much.begin());
  all.push_back(much);
  return all;
}

/// A process of a replay, of which this test is the other.
class LockstepSteps : public testing::Test {
 protected:
  LockstepSteps() {
    const std::filesystem::path file = test::write_filter_composition(folder_.path());
    child_ = std::make_unique<test::ChildProcess>(
        std::vector<std::string>{STRATA_PROGRAM, "run", file.string(), "--process", "p", "--child",
                                 std::to_string(getpid()), "--lockstep"},
        std::vector<std::string>{}, test::ChildProcess::Errors::kMerged);
    coordinator_ = std::make_unique<runtime::LockstepCoordinator>(
        participant_, std::vector<std::string>{"/filter"},
        [this](const std::string&, double) { return child_->runs(); });
  }
  /// All that is no message, each waited for, and then one without any bytes: Fast DDS takes that
  /// for no message at all, and what its writer sends behind it never comes.
  void send_no_messages(const std::string& topic, const std::string& type, const Bytes& good) {
    Stranger stranger(topic, type);
    ASSERT_TRUE(stranger.is_heard());
    stranger.send({0, 1});
    coordinator_->connect();
    for (const Bytes& bytes : no_messages(good)) stranger.send(bytes);
    ASSERT_TRUE(stranger.is_delivered());
    coordinator_->cycle();
    stranger.send({});
    coordinator_->cycle();
    EXPECT_TRUE(child_->runs()) << child_->rest();
  }
  void expect_good_end() {
    coordinator_->finish(folder_.path() / "out");
    child_->send(SIGTERM);
    EXPECT_EQ(child_->wait(), 0) << child_->rest();
  }

  test::TemporaryDirectory folder_;
  std::shared_ptr<bus::Participant> participant_ = test::make_participant();
  std::unique_ptr<test::ChildProcess> child_;
  std::unique_ptr<runtime::LockstepCoordinator> coordinator_;
};

TEST_F(LockstepSteps, ThatAreNoMessagesEndNoProcess) {
  Step step;
  step.kind(strata_msgs::msg::STEP_HELLO);
  step.target("/filter");
  step.sequence_number(1'000'000);
  step.out_dir((folder_.path() / "stray").string());
  step.expected().resize(1);
  step.expected()[0].topic("/scan");
  send_no_messages(runtime::kStepTopic, "strata_msgs/msg/Step", convert::to_cdr(step));
  expect_good_end();
}

TEST_F(LockstepSteps, AnswersThatAreNoneHoldUpNoReplay) {
  Ack ack;
  ack.sequence_number(1'000'000);
  ack.component_name("/filter");
  ack.ok(true);
  send_no_messages(runtime::kAckTopic, "strata_msgs/msg/Ack", convert::to_cdr(ack));
  expect_good_end();
}

}  // namespace
}  // namespace strata::tools
