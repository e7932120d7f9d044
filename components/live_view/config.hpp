// SPDX-License-Identifier: Apache-2.0
/// Parameters of strata::LiveView.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/config.hpp"

namespace strata::live_view {

/// Whether only this machine's programs can connect to it: "localhost", "127.0.0.1", "::1".
[[nodiscard]] inline bool is_loopback(std::string_view address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

/// Long enough not to be guessed, and the same in a URL as in a file.
[[nodiscard]] inline bool is_good_token(std::string_view token) {
  constexpr std::size_t kLeastLength = 16;
  return token.size() >= kLeastLength && std::all_of(token.begin(), token.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                  c == '-' || c == '_' || c == '.' || c == '~';
         });
}

struct LiveViewConfig {
  std::string address = "127.0.0.1";
  int port = 8765;
  std::string token;
  std::string certificate;
  std::string private_key;
  std::vector<std::string> origins;
  int max_viewers = 20;
  bool allow_commands = true;
  bool metrics = true;
  bool keep_newest = false;
  int max_topics = 1000;
  double forget_after_s = 60.0;
  std::string initial_pose_topic = "initialpose";
  std::string relocalize_service = "reinitialize_global_localization";
  std::string save_service = "scan_matcher/save";
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("address", c.address,
            {.doc = "where viewers connect; 0.0.0.0 is every network of this machine. Another than "
                    "this machine's own (127.0.0.1) needs token, certificate and private_key"});
    v.field("port", c.port,
            {.doc = "TCP port of the page and of Foxglove's protocol; 0: any free one, which "
                    "/diagnostics tells",
             .min = 0,
             .max = 65535});
    v.field("token", c.token,
            {.doc = "viewers must give it, as in https://robot:8765/?token=TOKEN; empty: none, on "
                    "this machine only"});
    v.require(c.token.empty() || is_good_token(c.token), "token",
              "is not at least 16 letters, digits and -._~",
              "make one, as with: openssl rand -hex 16");
    v.require(is_loopback(c.address) || !c.token.empty(), "token", "is missing for that address",
              "make one, as with: openssl rand -hex 16; or leave address at 127.0.0.1");
    v.field("certificate", c.certificate,
            {.doc = "PEM file of the certificate for TLS, those of the authorities between behind "
                    "it; read when configured; empty: plain HTTP, on this machine only"});
    v.field("private_key", c.private_key, {.doc = "PEM file of the certificate's private key"});
    v.require(c.certificate.empty() == c.private_key.empty(), "private_key",
              "and certificate are a pair", "give both, or none");
    v.require(is_loopback(c.address) || !c.certificate.empty(), "certificate",
              "is missing for that address: who is on that network could read the token",
              "make one with its key (docs/live-view.md), or leave address at 127.0.0.1 and come "
              "through a tunnel: ssh -L 8765:localhost:8765 robot");
    v.field("origins", c.origins,
            {.doc = "web pages of other hosts that may connect without a token, as "
                    "https://app.foxglove.dev; those of this machine's own address may anyway"});
    v.field("max_viewers", c.max_viewers,
            {.doc = "so many at a time; more are refused", .min = 1, .max = 1000});
    v.field("allow_commands", c.allow_commands,
            {.doc = "viewers may set the pose, ask for a global search, have maps saved, and "
                    "approve, activate and roll back versions of a site; else they only look"});
    v.field("metrics", c.metrics,
            {.doc = "answers /metrics for Prometheus; reads /diagnostics for it, viewers or not"});
    v.field("keep_newest", c.keep_newest,
            {.doc = "reads every topic from the start and gives its newest message to who comes "
                    "later, as if it were latched; for replays, where no topic is"});
    v.field(
        "max_topics", c.max_topics,
        {.doc = "so many topics at a time; more are left out, which /diagnostics tells", .min = 1});
    v.field("forget_after_s", c.forget_after_s,
            {.doc = "a topic that nobody has published for so long is taken back from viewers and "
                    "read no more, until it comes again; with keep_newest only to make room for "
                    "others",
             .unit = "s",
             .min = 0.0});
    v.field("initial_pose_topic", c.initial_pose_topic,
            {.doc = "geometry_msgs/PoseWithCovarianceStamped out: where a viewer says that the "
                    "robot is"});
    v.field("relocalize_service", c.relocalize_service,
            {.doc = "std_srvs/Empty that begins a global search"});
    v.field(
        "save_service", c.save_service,
        {.doc = "std_srvs/Trigger that saves the maps of a robot that maps; offered once somebody "
                "answers it; empty: none"});
  }
};

}  // namespace strata::live_view
