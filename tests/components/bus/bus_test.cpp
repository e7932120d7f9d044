// SPDX-License-Identifier: Apache-2.0
#include <condition_variable>
#include <future>
#include <mutex>
#include <new>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/endpoint.hpp"
#include "components/bus/participant_state.hpp"
#include "tests/components/bus/domain.hpp"

namespace strata::bus {
namespace {

using sensor_msgs::msg::LaserScan;
using std::chrono::seconds;

/// What a reader got, for a test to wait on.
class Inbox {
 public:
  [[nodiscard]] auto callback() {
    return [this](const LaserScan& scan) {
      const std::lock_guard lock(mutex_);
      scans_.push_back(scan);
      changed_.notify_all();
    };
  }
  [[nodiscard]] std::vector<LaserScan> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, seconds(20), [&] { return scans_.size() >= count; });
    return scans_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<LaserScan> scans_;
};

LaserScan example(int number, std::size_t beams = 360) {
  LaserScan scan;
  scan.header().frame_id("laser");
  scan.header().stamp().sec(number);
  for (std::size_t i = 0; i < beams; ++i) {
    scan.ranges().push_back(static_cast<float>(i) * 0.1F + static_cast<float>(number));
  }
  return scan;
}

TEST(Cdr, CarriesAMessageThereAndBack) {
  const LaserScan scan = example(3);
  EXPECT_EQ(convert::from_cdr<LaserScan>(convert::to_cdr(scan), "/scan"), scan);
}

TEST(Cdr, OfAMessageThatEndsEarlyIsAnInputErrorThatNamesTheTopic) {
  std::vector<std::uint8_t> bytes = convert::to_cdr(example(3));
  bytes.resize(bytes.size() / 2);
  try {
    (void)convert::from_cdr<LaserScan>(bytes, "/scan");
    FAIL() << "decoded half a message";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "/scan");
  }
}

void expect_in_order(Participant& /*keep*/, Writer<LaserScan>& writer, Inbox& inbox) {
  for (int i = 0; i < 500; ++i) writer.publish(example(i));
  const std::vector<LaserScan> got = inbox.wait_for(500);
  ASSERT_EQ(got.size(), 500U);
  for (int i = 0; i < 500; ++i) EXPECT_EQ(got[static_cast<std::size_t>(i)], example(i));
  EXPECT_EQ(writer.raw().count(), 500U);
}

TEST(Bus, DeliversEveryMessageInOneParticipant) {
  const auto participant = test::make_participant();
  Inbox inbox;
  Reader<LaserScan> reader(participant, "/scan", qos_profile("lossless"), inbox.callback());
  Writer<LaserScan> writer(participant, "/scan", qos_profile("lossless"));
  ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  expect_in_order(*participant, writer, inbox);
}

class BusTransports : public testing::TestWithParam<Transport> {};

TEST_P(BusTransports, DeliverEveryMessageBetweenParticipants) {
  const auto here = test::make_participant(GetParam());
  const auto there = test::make_participant(GetParam());
  Inbox inbox;
  Reader<LaserScan> reader(there, "/scan", qos_profile("lossless"), inbox.callback());
  Writer<LaserScan> writer(here, "/scan", qos_profile("lossless"));
  ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  ASSERT_TRUE(reader.raw().wait_for_writers(1, seconds(20)));
  expect_in_order(*here, writer, inbox);
}

INSTANTIATE_TEST_SUITE_P(All, BusTransports,
                         testing::Values(Transport::kLoopback, Transport::kSharedMemory));

TEST(Bus, RefusesAMessageShorterThanItsHeaderAtOnce) {
  const auto participant = test::make_participant();
  RawWriter writer(participant, TopicName("/scan"), "sensor_msgs/msg/LaserScan",
                   qos_profile("default"));
  for (std::size_t bytes = 0; bytes < 4; ++bytes) {
    try {
      writer.publish(std::vector<std::uint8_t>(bytes));
      FAIL() << "published " << bytes << " bytes";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), "/scan");
      EXPECT_THAT(error.what(), testing::HasSubstr("shorter than the header"));
    }
  }
  EXPECT_EQ(writer.count(), 0U);
}

TEST(Bus, HandsOverTheNextMessageAfterACallbackThatThrows) {
  const auto participant = test::make_participant();
  Inbox inbox;
  const auto keep = inbox.callback();
  Reader<LaserScan> reader(participant, "/scan", qos_profile("lossless"), [&](const auto& scan) {
    if (scan.header().stamp().sec() == 1) throw std::length_error("too long");
    if (scan.header().stamp().sec() == 2) throw std::bad_alloc();
    keep(scan);
  });
  Writer<LaserScan> writer(participant, "/scan", qos_profile("lossless"));
  ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  for (int i = 0; i < 4; ++i) writer.publish(example(i));
  EXPECT_THAT(inbox.wait_for(2), testing::ElementsAre(example(0), example(3)));
  EXPECT_EQ(participant->caught().count(), 2U);
  EXPECT_EQ(participant->caught().last(), "std::bad_alloc");
}

TEST(Bus, GoesOnWhenWhoIsToldOfAMatchThrows) {
  const auto participant = test::make_participant();
  Inbox inbox;
  Reader<LaserScan> reader(participant, "/scan", qos_profile("lossless"), inbox.callback(),
                           [] { throw std::runtime_error("not now"); });
  Writer<LaserScan> writer(participant, "/scan", qos_profile("lossless"),
                           [] { throw std::runtime_error("nor now"); });
  ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  ASSERT_TRUE(reader.raw().wait_for_writers(1, seconds(20)));
  writer.publish(example(1));
  EXPECT_THAT(inbox.wait_for(1), testing::ElementsAre(example(1)));
  EXPECT_EQ(participant->caught().count(), 2U);
}

TEST(Bus, LeavesNothingBehindOfAnEndpointThatCouldNotBeMade) {
  const auto participant = test::make_participant();
  const std::size_t before = participant->view().endpoints.size();
  participant->set_before_endpoint([](const std::string&) { throw std::bad_alloc(); });
  Inbox inbox;
  EXPECT_THROW(Reader<LaserScan>(participant, "/scan", qos_profile("default"), inbox.callback()),
               std::bad_alloc);
  EXPECT_THROW(Writer<LaserScan>(participant, "/scan", qos_profile("default")), std::bad_alloc);
  EXPECT_EQ(participant->view().endpoints.size(), before);
}

TEST(Bus, GivesALateJoinerTheLatchedMessage) {
  const auto here = test::make_participant();
  Writer<LaserScan> writer(here, "/map_like", qos_profile("latched"));
  writer.publish(example(1));
  writer.publish(example(2));
  const auto there = test::make_participant();
  Inbox inbox;
  Reader<LaserScan> reader(there, "/map_like", qos_profile("latched"), inbox.callback());
  EXPECT_THAT(inbox.wait_for(1), testing::ElementsAre(example(2)));
}

TEST(Bus, MatchesASensorReaderWithAReliableWriterButNotTheOtherWayRound) {
  const auto participant = test::make_participant();
  Inbox inbox;
  Reader<LaserScan> sensor(participant, "/a", qos_profile("sensor_data"), inbox.callback());
  Writer<LaserScan> reliable(participant, "/a", qos_profile("default"));
  EXPECT_TRUE(reliable.raw().wait_for_readers(1, seconds(20)));

  Reader<LaserScan> demanding(participant, "/b", qos_profile("default"), inbox.callback());
  Reader<LaserScan> witness(participant, "/b", qos_profile("sensor_data"), inbox.callback());
  Writer<LaserScan> careless(participant, "/b", qos_profile("sensor_data"));
  ASSERT_TRUE(careless.raw().wait_for_readers(1, seconds(20)));
  EXPECT_EQ(careless.raw().matched(), 1);
  EXPECT_EQ(demanding.raw().matched(), 0);
}

TEST(Bus, GrantsTheQosOfEveryNamedProfile) {
  const auto participant = test::make_participant();
  for (const std::string& name : qos_profile_names()) {
    const QosProfile asked = qos_profile(name);
    const RawWriter writer(participant, "/t_" + name, "sensor_msgs/msg/LaserScan", asked);
    const RawReader reader(participant, "/t_" + name, "sensor_msgs/msg/LaserScan", asked,
                           [](const RawMessage&) {});
    for (const QosProfile& granted : {writer.granted_qos(), reader.granted_qos()}) {
      EXPECT_EQ(granted.reliable, asked.reliable) << name;
      EXPECT_EQ(granted.transient_local, asked.transient_local) << name;
      EXPECT_EQ(granted.depth, asked.depth) << name;
    }
  }
}

TEST(Bus, FindsPeersHoweverManyUnseenParticipantsThereWere) {
  for (int i = 0; i < 40; ++i) (void)test::make_participant(Transport::kAlone);
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  Inbox inbox;
  Reader<LaserScan> reader(here, "/scan", qos_profile("default"), inbox.callback());
  const Writer<LaserScan> writer(there, "/scan", qos_profile("default"));
  EXPECT_TRUE(reader.raw().wait_for_writers(1, seconds(20)));
}

TEST(Bus, RefusesTwoTypesOnOneTopic) {
  const auto participant = test::make_participant();
  const RawWriter scans(participant, "/t", "sensor_msgs/msg/LaserScan", qos_profile("default"));
  EXPECT_THROW(RawWriter(participant, "/t", "nav_msgs/msg/Odometry", qos_profile("default")),
               ConfigError);
}

TEST(Bus, ListsTopicsOfOwnAndOtherParticipantsByTheirRos2Names) {
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  Writer<LaserScan> own(here, "/own", qos_profile("default"));
  Writer<LaserScan> other(there, "/other", qos_profile("default"));
  Inbox inbox;
  Reader<LaserScan> witness(here, "/other", qos_profile("default"), inbox.callback());
  ASSERT_TRUE(witness.raw().wait_for_writers(1, seconds(20)));
  const auto topics = here->published_topics();
  EXPECT_EQ(topics.at("/own").type, "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(topics.at("/other").type, "sensor_msgs/msg/LaserScan");
}

TEST(Bus, TellsWhatAllWritersOfATopicOffer) {
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  Writer<LaserScan> latched(there, "/l", qos_profile("latched"));
  Writer<LaserScan> sure(here, "/s", qos_profile("default"));
  Inbox inbox;
  Reader<LaserScan> witness(here, "/l", qos_profile("latched"), inbox.callback());
  ASSERT_TRUE(witness.raw().wait_for_writers(1, seconds(20)));
  EXPECT_TRUE(here->published_topics().at("/l").reliable);
  EXPECT_TRUE(here->published_topics().at("/l").transient_local);
  EXPECT_TRUE(here->published_topics().at("/s").reliable);
  EXPECT_FALSE(here->published_topics().at("/s").transient_local);
  {
    Writer<LaserScan> careless(here, "/s", qos_profile("sensor_data"));
    EXPECT_FALSE(here->published_topics().at("/s").reliable);
  }
  EXPECT_TRUE(here->published_topics().at("/s").reliable);
}

TEST(Bus, LetsAParticipantGoOnlyWhenTheOthersOfItsProcessKnowOfItsEnd) {
  const auto stays = test::make_participant();
  Inbox inbox;
  Reader<LaserScan> reader(stays, "/scan", qos_profile("lossless"), inbox.callback());
  auto ends = test::make_participant();
  {
    Writer<LaserScan> writer(ends, "/scan", qos_profile("lossless"));
    ASSERT_TRUE(writer.raw().wait_for_readers(1, seconds(20)));
  }
  std::future<void> end;
  {
    const std::lock_guard hears_nothing(stays->state().mutex);
    end = std::async(std::launch::async, [&] { ends.reset(); });
    EXPECT_EQ(end.wait_for(seconds(1)), std::future_status::timeout);
  }
  end.get();
  EXPECT_EQ(stays->view().participants.size(), 1U);
  // Fast DDS tells of this one to all that `stays` still knows, by their addresses.
  const Writer<LaserScan> writer(stays, "/other", qos_profile("lossless"));
}

TEST(Bus, ComplainsOfUnknownNames) {
  EXPECT_THROW((void)qos_profile("sensor"), ConfigError);
  EXPECT_THROW((void)transport_from_name("tcp"), ConfigError);
  ParticipantOptions beyond;
  beyond.domain = 233;
  EXPECT_THROW(Participant{beyond}, ConfigError);
}

}  // namespace
}  // namespace strata::bus
