// SPDX-License-Identifier: Apache-2.0
/// What viewers have a robot do.
#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/site_service_types.hpp"
#include "components/convert/geometry_messages.hpp"
#include "tests/components/live_view/live_view_fixture.hpp"
#include "tests/components/live_view/web_client.hpp"

namespace strata::live_view {
namespace {

using geometry_msgs::msg::PoseWithCovarianceStamped;

/// Reads on until that service is offered.
bool is_offered(test::WebClient& viewer, const std::string& name) {
  while (const auto offer = viewer.read_op("advertiseServices")) {
    for (const auto& service : offer->at("services")) {
      if (service.at("name") == name) return true;
    }
  }
  return false;
}

TEST_F(LiveViewTest, PublishesThePoseThatAViewerGives) {
  test::Collector<PoseWithCovarianceStamped> poses(robot_, "/initialpose", "default");
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  ASSERT_TRUE(poses.wait_for_writer());
  viewer.send({{"op", "advertise"},
               {"channels",
                {{{"id", 1},
                  {"topic", "/initialpose"},
                  {"encoding", "cdr"},
                  {"schemaName", "geometry_msgs/msg/PoseWithCovarianceStamped"}}}}});
  PoseWithCovarianceStamped pose;
  pose.header(convert::make_header(Stamp{5}, "map"));
  pose.pose().pose().position().x(3.5);
  const auto cdr = convert::to_cdr(pose);
  viewer.send_binary(std::string("\1\1\0\0\0", 5) + std::string(cdr.begin(), cdr.end()));
  const auto found = poses.wait_for(1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], pose);
}

TEST_F(LiveViewTest, SaysThatNobodyAnswersACall) {
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  viewer.send_binary(std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21));
  const auto failure = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(failure.has_value());
  EXPECT_THAT(failure->at("message").get<std::string>(),
              testing::HasSubstr("/reinitialize_global_localization"));
}

TEST_F(LiveViewTest, AsksTheLocalizerToSearchEverywhere) {
  std::atomic<int> asked{0};
  const auto mailbox = std::make_shared<runtime::Mailbox>();
  runtime::ServiceHub services(robot_, mailbox, [](const std::exception&) {});
  services.serve<bus::srv::Empty>("/reinitialize_global_localization", "default", [&](const auto&) {
    ++asked;
    return std_srvs::srv::Empty_Response();
  });
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  viewer.send_binary(std::string("\2\1\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21));
  std::optional<test::Received> answer;
  do {
    answer = viewer.read();
    ASSERT_TRUE(answer.has_value());
  } while (!answer->is_binary);
  EXPECT_EQ(answer->bytes[0], 3);
  EXPECT_EQ(asked, 1);
}

TEST_F(LiveViewTest, HasTheMapperSaveAndTellsWhatItSays) {
  std::atomic<bool> is_full{false};
  const auto mailbox = std::make_shared<runtime::Mailbox>();
  runtime::ServiceHub services(robot_, mailbox, [](const std::exception&) {});
  services.serve<bus::srv::Trigger>("/scan_matcher/save", "default", [&](const auto&) {
    std_srvs::srv::Trigger_Response response;
    response.success(!is_full);
    response.message(is_full ? "the disk is full" : "saved in maps");
    return response;
  });
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  ASSERT_TRUE(is_offered(viewer, "/scan_matcher/save"));
  const std::string call("\2\2\0\0\0\5\0\0\0\3\0\0\0cdr\0\1\0\0\0", 21);
  viewer.send_binary(call);
  std::optional<test::Received> answer;
  do {
    answer = viewer.read();
    ASSERT_TRUE(answer.has_value());
  } while (!answer->is_binary);
  EXPECT_EQ(answer->bytes.substr(0, 9), std::string("\3\2\0\0\0\5\0\0\0", 9));
  EXPECT_THAT(answer->bytes, testing::HasSubstr("saved in maps"));
  is_full = true;
  viewer.send_binary(call);
  const auto failure = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(failure.has_value());
  EXPECT_EQ(failure->at("serviceId"), 2);
  EXPECT_THAT(failure->at("message").get<std::string>(), testing::HasSubstr("the disk is full"));
}

TEST_F(LiveViewTest, HasAVersionActivatedWhereAComponentTellsOfItsSiteAndTellsARefusal) {
  std::atomic<bool> is_approved{true};
  std::string asked;
  const auto mailbox = std::make_shared<runtime::Mailbox>();
  runtime::ServiceHub services(robot_, mailbox, [](const std::exception&) {});
  services.serve<bus::srv::ActivateSiteVersion>(
      "/hall/localizer/activate_version", "default", [&](const auto& request) {
        asked = request.version() + " by " + request.by();
        strata_msgs::srv::ActivateSiteVersion_Response response;
        response.success(is_approved);
        response.message(is_approved ? "version 2 is active" : "version 2: was not approved");
        return response;
      });
  const bus::Writer<strata_msgs::msg::SiteVersions> told(
      robot_, std::string("/hall/localizer/site_versions"), bus::qos_profile("latched"));
  test::WebClient viewer;
  ASSERT_EQ(viewer.connect(port()), 101);
  ASSERT_TRUE(is_offered(viewer, "/hall/localizer/activate_version"));
  strata_msgs::srv::ActivateSiteVersion_Request request;
  request.version("2");
  request.by("ada");
  const auto cdr = convert::to_cdr(request);
  const std::string call =
      std::string("\2\4\0\0\0\5\0\0\0\3\0\0\0cdr", 16) + std::string(cdr.begin(), cdr.end());
  viewer.send_binary(call);
  std::optional<test::Received> answer;
  do {
    answer = viewer.read();
    ASSERT_TRUE(answer.has_value());
  } while (!answer->is_binary);
  EXPECT_THAT(answer->bytes, testing::HasSubstr("version 2 is active"));
  EXPECT_EQ(asked, "2 by ada");
  is_approved = false;
  viewer.send_binary(call);
  const auto failure = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(failure.has_value());
  EXPECT_EQ(failure->at("message"), "version 2: was not approved");
  viewer.send_binary(call.substr(0, 20));
  const auto broken = viewer.read_op("serviceCallFailure");
  ASSERT_TRUE(broken.has_value()) << "a request that does not decode is answered, too";
  EXPECT_THAT(broken->at("message").get<std::string>(),
              testing::HasSubstr("a viewer's /hall/localizer/activate_version"));
}

}  // namespace
}  // namespace strata::live_view
