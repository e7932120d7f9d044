// SPDX-License-Identifier: Apache-2.0
/// What a bag says of writers that are not ours: the hash of their type and what they offer.
#include <map>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "components/bus/names.hpp"
#include "components/bus/raw_type.hpp"
#include "components/bus/transports.hpp"
#include "tests/components/recorder/recorder_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::recorder {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

/// A process of its own would make no difference: another participant, with QoS of its own.
class ForeignWriter {
 public:
  ForeignWriter(const std::string& topic, const std::string& type, const dds::DataWriterQos& qos) {
    bus::ParticipantOptions options;
    options.domain = test::own_domain();
    options.transport = bus::Transport::kLoopback;
    participant_ = factory().create_participant(static_cast<dds::DomainId_t>(options.domain),
                                                bus::participant_qos(options));
    const std::string wire_type = bus::wire_type(type);
    participant_->register_type(dds::TypeSupport(new bus::RawType(wire_type)));
    dds::Topic* made =
        participant_->create_topic(bus::wire_topic(topic), wire_type, dds::TOPIC_QOS_DEFAULT);
    participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT)->create_datawriter(made, qos);
  }
  ~ForeignWriter() {
    participant_->delete_contained_entities();
    factory().delete_participant(participant_);
  }
  ForeignWriter(const ForeignWriter&) = delete;
  ForeignWriter& operator=(const ForeignWriter&) = delete;

 private:
  static dds::DomainParticipantFactory& factory() {
    return *dds::DomainParticipantFactory::get_instance();
  }
  dds::DomainParticipant* participant_ = nullptr;
};

dds::DataWriterQos qos_with_hash(const std::string& hash) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  const std::string text = "typehash=" + hash + ";";
  qos.user_data().setValue(std::vector<eprosima::fastrtps::rtps::octet>(text.begin(), text.end()));
  return qos;
}

const std::string kHash = "RIHS01_" + std::string(64, '7');
const std::string kOther = "RIHS01_" + std::string(64, '8');

class RecorderOffers : public RecorderStorage {
 protected:
  /// What the bag says of each topic once each has so many writers.
  std::map<std::string, log::BagTopic> record(const std::map<std::string, std::size_t>& writers) {
    for (const auto& [topic, count] : writers) {
      EXPECT_TRUE(test::comes_true([&] {
        const auto published = participant_->published_topics();
        const auto found = published.find(topic);
        return found != published.end() && found->second.writers.size() == count;
      })) << topic;
    }
    const auto host = make("");
    host->activate();
    host->stop();
    EXPECT_TRUE(host->take_errors().empty());
    std::map<std::string, log::BagTopic> topics;
    const auto reader = log::BagReader::open(bag());
    for (const log::BagTopic& topic : reader->topics()) topics[topic.name] = topic;
    return topics;
  }
  [[nodiscard]] bool tells_hashes() const {
    return std::string(GetParam().description) != "SQLite schema 3";
  }
};

TEST_P(RecorderOffers, KeepTheHashThatTheWritersTellOfTheirType) {
  const ForeignWriter thing("/thing", "strange_msgs/msg/Thing", qos_with_hash(kHash));
  const ForeignWriter newer("/newer", "std_msgs/msg/String", qos_with_hash(kHash));
  const ForeignWriter one("/both", "strange_msgs/msg/Thing", qos_with_hash(kHash));
  const ForeignWriter two("/both", "strange_msgs/msg/Thing", qos_with_hash(kOther));
  const auto topics = record({{"/thing", 1}, {"/newer", 1}, {"/both", 2}});
  const std::string hash = tells_hashes() ? kHash : "";
  EXPECT_EQ(topics.at("/thing").type_hash, hash);
  EXPECT_EQ(topics.at("/newer").type_hash, hash) << "of the type as its writer has it";
  EXPECT_EQ(topics.at("/both").type_hash, "") << "they do not agree";
  const std::string metadata = (bag() / "metadata.yaml").string();
  for (const YAML::Node& topic :
       YAML::LoadFile(metadata)["rosbag2_bagfile_information"]["topics_with_message_count"]) {
    const YAML::Node told = topic["topic_metadata"];
    if (told["name"].as<std::string>() != "/thing") continue;
    EXPECT_EQ(told["type_description_hash"].as<std::string>(""), hash);
  }
}

TEST_P(RecorderOffers, OfATypeThatNobodyKnowsHaveNoDefinition) {
  const ForeignWriter thing("/thing", "strange_msgs/msg/Thing", qos_with_hash(kHash));
  const ForeignWriter text("/text", "std_msgs/msg/String", qos_with_hash(kHash));
  const auto topics = record({{"/thing", 1}, {"/text", 1}});
  EXPECT_EQ(topics.at("/thing").definition, "");
  if (!tells_hashes()) return;  // nor any definition
  EXPECT_EQ(topics.at("/thing").definition_encoding, "");
  EXPECT_EQ(topics.at("/text").definition_encoding, "ros2msg");
}

std::string qos_line(const YAML::Node& qos) {
  const auto time = [&](const char* key) {
    return qos[key]["sec"].as<std::string>() + "." + qos[key]["nsec"].as<std::string>();
  };
  return qos["reliability"].as<std::string>() + " " + time("deadline") + " " + time("lifespan") +
         " " + qos["liveliness"].as<std::string>() + " " + time("liveliness_lease_duration");
}

TEST_P(RecorderOffers, AreKeptOfEachWriterWithItsTimes) {
  dds::DataWriterQos qos = qos_with_hash(kHash);
  qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.deadline().period = Duration_t(0, 250'000'000);
  qos.lifespan().duration = Duration_t(3, 500'000'000);
  qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = Duration_t(2, 0);
  qos.liveliness().announcement_period = Duration_t(1, 0);
  const ForeignWriter thing("/thing", "strange_msgs/msg/Thing", qos);
  const ForeignWriter plain("/thing", "strange_msgs/msg/Thing", qos_with_hash(kHash));
  bus::Writer<sensor_msgs::msg::LaserScan> own(participant_, "/own", bus::qos_profile("rosout"));
  const auto topics = record({{"/thing", 2}, {"/own", 1}});
  std::vector<std::string> offered;
  for (const YAML::Node& each : YAML::Load(topics.at("/thing").offered_qos_profiles)) {
    offered.push_back(qos_line(each));
  }
  const std::string forever = "9223372036.854775807";
  EXPECT_THAT(offered,
              testing::UnorderedElementsAre("2 0.250000000 3.500000000 3 2.0",
                                            "1 " + forever + " " + forever + " 1 " + forever));
  EXPECT_EQ(qos_line(YAML::Load(topics.at("/own").offered_qos_profiles)[0]),
            "1 " + forever + " 10.0 1 " + forever);
}

INSTANTIATE_TEST_SUITE_P(All, RecorderOffers,
                         testing::Values(Storage{"Sqlite3", "sqlite3", "SQLite schema 3"},
                                         Storage{"Sqlite3SchemaFour", "sqlite3, sqlite_schema: 4",
                                                 "SQLite schema 4"},
                                         Storage{"Mcap", "mcap", "MCAP"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace strata::recorder
