// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/web_access.hpp"

#include <gtest/gtest.h>

namespace strata::live_view {
namespace {

const std::string kToken = "0123456789abcdef";

WebRequest local() { return {"GET", "/", "localhost:8765", "", ""}; }
WebRequest from(std::string_view origin, std::string_view host = "localhost:8765") {
  return {"GET", "/", host, origin, ""};
}
WebRequest at(std::string_view target) { return {"GET", target, "robot:8765", "", ""}; }

TEST(WebAccess, LetsThisMachinesProgramsAndItsOwnPageIn) {
  EXPECT_EQ(judge({}, local()).status, 200);
  EXPECT_EQ(judge({}, from("http://localhost:8765")).status, 200);
  EXPECT_EQ(judge({}, from("http://127.0.0.1:8765", "127.0.0.1:8765")).status, 200);
  EXPECT_EQ(judge({}, from("http://[::1]:8765", "[::1]:8765")).status, 200);
}

TEST(WebAccess, OverTlsLetsItsOwnPageInFromThereOnly) {
  AccessRules rules;
  rules.is_secure = true;
  EXPECT_EQ(judge(rules, from("https://localhost:8765")).status, 200);
  EXPECT_EQ(judge(rules, from("http://localhost:8765")).status, 403) << "anybody could be that";
  EXPECT_EQ(judge({}, from("https://localhost:8765")).status, 403);
}

TEST(WebAccess, RefusesPagesOfOtherHostsUnlessTheyAreNamed) {
  EXPECT_EQ(judge({}, from("https://evil.example")).status, 403);
  EXPECT_EQ(judge({}, from("http://localhost:9000")).status, 403) << "another server's page";
  EXPECT_EQ(judge({}, from("null")).status, 403);
  const AccessRules named{"", {"https://app.foxglove.dev"}};
  EXPECT_EQ(judge(named, from("https://app.foxglove.dev")).status, 200);
  EXPECT_EQ(judge(named, from("https://app.foxglove.dev.evil.example")).status, 403);
}

TEST(WebAccess, RefusesNamesThatWereMadeToPointHere) {
  for (const char* host : {"evil.example:8765", "127.evil.example", "127.0.0.1.evil.example",
                           "localhost.evil.example:8765", "", "["}) {
    EXPECT_EQ(judge({}, from("http://" + std::string(host), host)).status, 403) << host;
  }
}

TEST(WebAccess, WantsTheTokenWhenThereIsOne) {
  const AccessRules rules{kToken, {}};
  EXPECT_EQ(judge(rules, local()).status, 401) << "on this machine, too";
  EXPECT_EQ(judge(rules, at("/?token=" + kToken)).status, 200);
  EXPECT_EQ(judge(rules, at("/?a=b&token=" + kToken + "&c")).status, 200);
  WebRequest bearer = at("/");
  const std::string header = "Bearer " + kToken;
  bearer.authorization = header;
  EXPECT_EQ(judge(rules, bearer).status, 200);
  WebRequest foreign = at("/");
  const std::string target = "/?token=" + kToken;
  foreign.target = target;
  foreign.origin = "https://app.foxglove.dev";
  EXPECT_EQ(judge(rules, foreign).status, 200) << "who has it may come from anywhere";
}

TEST(WebAccess, RefusesEveryOtherToken) {
  const AccessRules rules{kToken, {}};
  for (const std::string& wrong :
       {std::string(), kToken.substr(1), kToken + "0", kToken + kToken, std::string("0"),
        std::string("0123456789abcdeF"), "x" + kToken}) {
    EXPECT_EQ(judge(rules, at("/?token=" + wrong)).status, 401) << wrong;
    EXPECT_EQ(judge(rules, at("/?xtoken=" + wrong)).status, 401) << wrong;
  }
  EXPECT_EQ(judge(rules, at("/?xtoken=" + kToken)).status, 401);
}

TEST(WebAccess, GuardsTheMetricsAsThePage) {
  EXPECT_EQ(judge({}, {"GET", "/metrics", "localhost:8765", "", ""}).status, 200);
  EXPECT_EQ(judge({}, {"GET", "/metrics", "robot:8765", "", ""}).status, 403);
  EXPECT_EQ(judge({}, {"GET", "/metrics", "localhost", "https://evil.example", ""}).status, 403);
  const AccessRules rules{kToken, {}};
  EXPECT_EQ(judge(rules, at("/metrics")).status, 401);
  EXPECT_EQ(judge(rules, at("/metrics?token=" + kToken)).status, 200);
}

TEST(WebAccess, HasNothingButThePageAndTheMetrics) {
  for (const char* target :
       {"/etc/passwd", "/../../etc/passwd", "//", "/.", "/%2e%2e/", "", "*",
        "http://localhost:8765/", "/index.html?token=x", "/metrics/", "/metricsx"}) {
    WebRequest request = local();
    request.target = target;
    EXPECT_EQ(judge({}, request).status, 404) << target;
  }
  WebRequest post = local();
  post.method = "POST";
  EXPECT_EQ(judge({}, post).status, 405);
}

}  // namespace
}  // namespace strata::live_view
