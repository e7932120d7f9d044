// SPDX-License-Identifier: Apache-2.0
/// What comes on the topic of a service's requests, and who answers them.
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/domain_view.hpp"
#include "components/bus/service.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::bus {
namespace {

RawMessage of(std::uint16_t vendor, std::size_t bytes) {
  RawMessage message;
  message.identity.writer[0] = static_cast<std::uint8_t>(vendor >> 8);
  message.identity.writer[1] = static_cast<std::uint8_t>(vendor & 0xFF);
  message.cdr.assign(bytes, 1);
  return message;
}

TEST(ServiceRequest, OfTooFewBytesIsRefused) {
  for (std::size_t bytes = 0; bytes < 30; ++bytes) {
    if (bytes < 4) {
      EXPECT_THROW((void)read_service_request(of(kVendorFastDds, bytes)), InputError) << bytes;
    } else {
      EXPECT_EQ(read_service_request(of(kVendorFastDds, bytes)).cdr.size(), bytes);
    }
    if (bytes < 20) {
      EXPECT_THROW((void)read_service_request(of(kVendorCyclone, bytes)), InputError) << bytes;
    } else {
      const ServiceRequest request = read_service_request(of(kVendorCyclone, bytes));
      EXPECT_EQ(request.cdr.size(), bytes - 16);
      EXPECT_TRUE(request.prefix);
    }
  }
}

TEST(ServiceRequest, OfTooFewBytesNamesItsSize) {
  try {
    (void)read_service_request(of(kVendorCyclone, 7));
    FAIL() << "was taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("has 7 bytes"));
  }
}

TEST(Service, IsAnsweredWhileSomebodyServesIt) {
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  const auto serve = [](const std::shared_ptr<Participant>& participant, const char* name) {
    return std::make_unique<ServiceServer>(
        participant, name, "std_srvs/srv/Trigger", qos_profile("default"), [](const auto&) {},
        [] {});
  };
  EXPECT_FALSE(here->is_answered("/mapper/save"));
  auto own = serve(here, "/own/save");
  EXPECT_TRUE(here->is_answered("/own/save"));
  auto other = serve(there, "/mapper/save");
  EXPECT_TRUE(test::comes_true([&] { return here->is_answered("/mapper/save"); }));
  EXPECT_FALSE(here->is_answered("/mapper/sav"));
  EXPECT_FALSE(here->is_answered("/save"));
  other.reset();
  EXPECT_TRUE(test::comes_true([&] { return !here->is_answered("/mapper/save"); }));
}

}  // namespace
}  // namespace strata::bus
