// SPDX-License-Identifier: Apache-2.0
/// What viewers ask of the hub.
#include <random>
#include <string>
#include <vector>

#include "components/live_view/view_hub.hpp"
#include "tests/components/live_view/view_hub_fixture.hpp"

namespace strata::live_view {
namespace {

using Json = nlohmann::json;

TEST_F(ViewHubTest, LetsViewersPublishThePoseAndNothingElse) {
  const ViewerId viewer = joined();
  const std::string type = "geometry_msgs/msg/PoseWithCovarianceStamped";
  const auto advertise = [&](int id, const std::string& topic) {
    hub_.take(viewer, false,
              Json{{"op", "advertise"},
                   {"channels",
                    {{{"id", id}, {"topic", topic}, {"schemaName", type}, {"encoding", "cdr"}}}}}
                  .dump());
  };
  advertise(1, "/cmd_vel");
  hub_.take(viewer, true, std::string("\1\1\0\0\0pose", 9));
  EXPECT_TRUE(hub_.take_commands().empty());
  EXPECT_EQ(hub_.counts().refused, 2U);
  advertise(1, "/initialpose");
  hub_.take(viewer, true, std::string("\1\1\0\0\0pose", 9));
  const auto commands = hub_.take_commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].cdr, (std::vector<std::uint8_t>{'p', 'o', 's', 'e'}));
}

TEST_F(ViewHubTest, BoundsWhatWaitsOfViewersThatAskForMuch) {
  const ViewerId viewer = joined();
  const std::string call("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr", 16);
  for (int i = 0; i < 5000; ++i) hub_.take(viewer, true, call);
  EXPECT_EQ(hub_.take_commands().size(), 16U);
  EXPECT_LE(texts(viewer).size(), 1000U);
}

TEST_F(ViewHubTest, AnswersACallToWhoCalled) {
  const ViewerId viewer = joined();
  hub_.take(viewer, true, std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr", 16));
  const auto commands = hub_.take_commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].kind, ViewCommand::Kind::kRelocalize);
  (void)texts(viewer);
  hub_.answer(commands[0], "", {0, 1, 0, 0, 0});
  const auto frame = hub_.next(viewer);
  ASSERT_TRUE(frame.has_value());
  const std::string expected("\3\1\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21);
  EXPECT_EQ(std::string(frame->head.begin(), frame->head.end()), expected);
  hub_.answer(commands[0], "nobody answers", {});
  const auto failure = texts(viewer);
  ASSERT_EQ(failure.size(), 1U);
  EXPECT_EQ(failure[0].at("op"), "serviceCallFailure");
  EXPECT_EQ(failure[0].at("callId"), 5);
}

TEST_F(ViewHubTest, OffersASiteToThoseWhoAreThereAndThoseWhoCome) {
  const ViewerId first = joined();
  (void)texts(first);
  hub_.offer_site("/localizer", true);
  const auto told = texts(first);
  ASSERT_EQ(told.size(), 1U);
  const Json& services = told[0].at("services");
  ASSERT_EQ(services.size(), 4U);
  EXPECT_EQ(services[0].at("name"), "/localizer/approve_version");
  EXPECT_EQ(services[0].at("type"), "strata_msgs/srv/ApproveSiteVersion");
  EXPECT_EQ(services[0].at("request").at("schema"),
            "string version\nstring by\nstring note\nbool unchecked\n");
  EXPECT_EQ(texts(joined()).back().at("services").size(), 5U) << "with the search, and no save";
  const std::string call("\2\3\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0abcd", 24);
  hub_.take(first, true, call);
  const auto commands = hub_.take_commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].kind, ViewCommand::Kind::kApproveVersion);
  EXPECT_EQ(commands[0].service, "/localizer/approve_version");
  EXPECT_EQ(std::string(commands[0].cdr.begin(), commands[0].cdr.end()), call.substr(16));
  hub_.take(first, true, call.substr(0, 12));
  hub_.take(first, true, call.substr(0, 9) + std::string("\377\377\377\377cdr", 7));
  EXPECT_TRUE(hub_.take_commands().empty()) << "cut, or longer than it is";
  hub_.answer(commands[0], "was not approved", {});
  EXPECT_EQ(texts(first).back().at("serviceId"), 3);
}

TEST(ViewHubServices, OfferToSaveMapsOnceSomebodyWould) {
  ViewHub hub("strata", {"/initialpose", "/search", "/mapper/save"}, 2);
  const auto services = [&](ViewerId viewer) {
    std::vector<std::string> names;
    while (const auto frame = hub.next(viewer)) {
      const Json said = Json::parse(frame->head);
      if (said.at("op") != "advertiseServices") continue;
      for (const Json& service : said.at("services")) names.push_back(service.at("name"));
    }
    return names;
  };
  using Names = std::vector<std::string>;
  const std::string save("\2\2\0\0\0\5\0\0\0\3\0\0\0cdr", 16);
  const ViewerId first = hub.join([] {}).value();
  EXPECT_EQ(services(first), Names{"/search"});
  hub.take(first, true, save);
  EXPECT_TRUE(hub.take_commands().empty());
  hub.offer_save();
  EXPECT_EQ(services(first), Names{"/mapper/save"});
  EXPECT_EQ(services(hub.join([] {}).value()), (Names{"/search", "/mapper/save"}));
  hub.take(first, true, save);
  const auto commands = hub.take_commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].kind, ViewCommand::Kind::kSaveMaps);
}

TEST(ViewHubServices, LetViewersTellTheLevelOfABuilding) {
  ViewHub hub("strata", {"/initialpose", "/search", ""}, 1);
  const ViewerId viewer = hub.join([] {}).value();
  while (hub.next(viewer)) {
  }
  hub.offer_levels("/hall/localizer");
  const Json services = Json::parse(hub.next(viewer)->head).at("services");
  ASSERT_EQ(services.size(), 1U);
  EXPECT_EQ(services[0].at("name"), "/hall/localizer/set_level");
  EXPECT_EQ(services[0].at("request").at("schema"), "string level\n");
  hub.take(viewer, true, std::string("\2\7\0\0\0\5\0\0\0\3\0\0\0cdr", 16));
  const auto commands = hub.take_commands();
  ASSERT_EQ(commands.size(), 1U);
  EXPECT_EQ(commands[0].kind, ViewCommand::Kind::kSetLevel);
  EXPECT_EQ(commands[0].service, "/hall/localizer/set_level");
}

TEST(ViewHubServices, OfferNoSaveWhereViewersOnlyLook) {
  ViewHub hub("strata", {}, 1);
  const ViewerId viewer = hub.join([] {}).value();
  while (hub.next(viewer)) {
  }
  hub.offer_save();
  EXPECT_FALSE(hub.next(viewer).has_value());
}

TEST(ViewHubWithoutCommands, OfMapsOfASiteOnly) {
  ViewHub hub("strata", {}, 1);
  hub.offer_site("/localizer", false);
  const ViewerId viewer = hub.join([] {}).value();
  EXPECT_EQ(Json::parse(hub.next(viewer)->head).at("capabilities"), Json({"services"}));
  const Json services = Json::parse(hub.next(viewer)->head).at("services");
  ASSERT_EQ(services.size(), 1U);
  EXPECT_EQ(services[0].at("name"), "/localizer/version_map");
  for (const char id : {3, 4, 5}) {
    hub.take(viewer, true, std::string("\2") + id + std::string("\0\0\0\5\0\0\0\3\0\0\0cdr", 14));
  }
  EXPECT_TRUE(hub.take_commands().empty());
  EXPECT_EQ(hub.counts().refused, 3U);
}

TEST(ViewHubWithoutCommands, OffersAndTakesNone) {
  ViewHub hub("strata", {}, 1);
  const ViewerId viewer = hub.join([] {}).value();
  const auto info = hub.next(viewer);
  EXPECT_TRUE(Json::parse(info->head).at("capabilities").empty());
  EXPECT_FALSE(hub.next(viewer).has_value());
  hub.take(viewer, false,
           R"({"op":"advertise","channels":[{"id":1,"topic":"","encoding":"cdr",)"
           R"("schemaName":"geometry_msgs/msg/PoseWithCovarianceStamped"}]})");
  hub.take(viewer, true, std::string("\1\1\0\0\0", 5));
  hub.take(viewer, true, std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr", 16));
  EXPECT_TRUE(hub.take_commands().empty());
  EXPECT_EQ(hub.counts().refused, 3U);
}

TEST_F(ViewHubTest, LivesThroughMutatedMessages) {
  const auto scan = hub_.advertise("/scan", "a/msg/B", "x", false);
  const ViewerId viewer = joined();
  const std::vector<std::string> seeds = {
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})",
      R"({"op":"unsubscribe","subscriptionIds":[0,1]})",
      R"({"op":"advertise","channels":[{"id":1,"topic":"/initialpose","encoding":"cdr"}]})",
      std::string("\1\1\0\0\0\0\1\0\0", 9), std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr", 16)};
  std::mt19937 random(1);
  const auto below = [&](std::size_t bound) { return random() % bound; };
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = seeds[below(seeds.size())];
    for (std::size_t n = below(4); n > 0 && !bytes.empty(); --n) {
      const std::size_t at = below(bytes.size());
      switch (below(3)) {
        case 0:
          bytes[at] = static_cast<char>(below(256));
          break;
        case 1:
          bytes.erase(at, below(8));
          break;
        default:
          bytes.insert(at, std::to_string(random()));
          break;
      }
    }
    hub_.take(viewer, below(2) == 0, bytes);
    if (i % 100 == 0) {
      hub_.publish(scan, message(1));
      (void)contents(viewer);
      (void)hub_.take_commands();
    }
  }
  EXPECT_GT(hub_.counts().refused, 1000U);
  (void)texts(viewer);
  hub_.take(viewer, false, R"({"op":"clientInfo"})");
  EXPECT_FALSE(hub_.next(viewer).has_value());
}

TEST_F(ViewHubTest, TakesDeepNestsForNoMessage) {
  const ViewerId viewer = joined();
  hub_.take(viewer, false, std::string(200000, '['));
  hub_.take(viewer, false, std::string(100000, '[') + std::string(100000, ']'));
  EXPECT_EQ(hub_.counts().refused, 2U);
}

}  // namespace
}  // namespace strata::live_view
