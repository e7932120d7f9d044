// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/connection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

TEST(ServerUrl, IsToldWithoutUserAndPassword) {
  EXPECT_EQ(url_without_secrets("postgresql://r1:secret@host:5433/fleet?sslmode=verify-full"),
            "postgresql://host:5433/fleet");
  EXPECT_EQ(url_without_secrets("host=/run/pg dbname=fleet user=r1 password=secret"),
            "postgresql:///fleet?host=/run/pg");
  EXPECT_EQ(url_for("postgresql://host:5433/fleet", "hall.r1"),
            "postgresql://hall.r1@host:5433/fleet");
  EXPECT_THAT([] { (void)url_without_secrets("postgresql://r1:secret@host:5433/x?nonsense=1"); },
              ThrowsMessage<InputError>(Not(HasSubstr("secret"))));
}

TEST(ServerUrl, OfNoServerIsTold) {
  EXPECT_THAT([] { Connection("postgresql://r1:secret@/fleet?host=/nowhere"); },
              ThrowsMessage<LostError>(
                  testing::AllOf(HasSubstr("cannot be reached"), Not(HasSubstr("secret")))));
}

class ServerConnection : public testing::Test {
 protected:
  void SetUp() override {
    STRATA_REQUIRE_POSTGRES();
    server_.emplace();
  }
  std::optional<test::PostgresServer> server_;
};

TEST_F(ServerConnection, WithoutTheRightPasswordIsDenied) {
  EXPECT_THAT([&] { Connection(server_->url("admin", "wrong")); },
              ThrowsMessage<DeniedError>(HasSubstr("check user, password and database")));
  EXPECT_THAT(
      [&] { Connection("postgresql://admin@/postgres?host=" + server_->folder().string()); },
      ThrowsMessage<DeniedError>(HasSubstr(".pgpass")));
}

TEST_F(ServerConnection, GivesBackWhatIsBound) {
  Connection admin = server_->admin();
  const std::string odd = "'; DROP TABLE x; -- \\ \" \u00e9";
  EXPECT_EQ(admin.query("SELECT $1::text", {odd}).text(0, 0), odd);
  EXPECT_EQ(
      admin.query("SELECT $1::bigint", {std::int64_t{-9'000'000'000'000'000'000}}).integer(0, 0),
      -9'000'000'000'000'000'000);
  EXPECT_EQ(admin.query("SELECT $1::float8", {0.1 + 0.2}).real(0, 0), 0.1 + 0.2);
  std::vector<std::byte> all;
  for (int i = 0; i < 256; ++i) all.push_back(static_cast<std::byte>(i));
  const Rows rows = admin.query_bytes("SELECT $1::bytea", {std::span<const std::byte>(all)});
  EXPECT_TRUE(std::equal(all.begin(), all.end(), rows.bytes(0, 0).begin(), rows.bytes(0, 0).end()));
  EXPECT_TRUE(admin.query("SELECT NULL").is_null(0, 0));
  EXPECT_THROW((void)admin.query("SELECT 'x'").integer(0, 0), OutputError);
}

TEST_F(ServerConnection, UndoesATransactionThatThrows) {
  Connection admin = server_->admin();
  (void)admin.query("CREATE TABLE public.t (x int)");
  EXPECT_THROW(admin.transaction([&] {
    (void)admin.query("INSERT INTO public.t VALUES (1)");
    throw InputError("here", "is wrong", "mend it");
  }),
               InputError);
  EXPECT_EQ(admin.query("SELECT FROM public.t").size(), 0U);
  admin.transaction([&] { (void)admin.query("INSERT INTO public.t VALUES (2)"); });
  EXPECT_EQ(admin.query("SELECT FROM public.t").size(), 1U);
}

TEST_F(ServerConnection, DoesNotWaitForEver) {
  Connection admin(server_->url(), {.statement_s = 1});
  EXPECT_THAT([&] { (void)admin.query("SELECT pg_sleep(600)"); },
              ThrowsMessage<ServerError>(HasSubstr("took longer than 1 s")));
  Connection other = server_->admin();
  (void)other.query("CREATE TABLE public.t (x int)");
  other.transaction([&] {
    (void)other.query("LOCK TABLE public.t");
    EXPECT_THAT([&] { (void)admin.query("SELECT FROM public.t"); },
                ThrowsMessage<ServerError>(HasSubstr("took longer")));
  });
}

TEST_F(ServerConnection, ThatIsCutIsTold) {
  Connection admin = server_->admin();
  Connection other = server_->admin();
  (void)other.query(
      "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE pid <> "
      "pg_backend_pid() AND usename = 'admin'");
  EXPECT_THAT([&] { (void)admin.query("SELECT 1"); },
              ThrowsMessage<LostError>(HasSubstr("run it again")));
}

/// As on a full disk, which PostgreSQL tells by the same code.
TEST_F(ServerConnection, ToAServerWithoutSpaceIsTold) {
  Connection admin = server_->admin();
  EXPECT_THAT(
      [&] {
        (void)admin.query(
            "DO $$ BEGIN RAISE EXCEPTION 'could not extend file' USING ERRCODE = "
            "'disk_full'; END $$");
      },
      ThrowsMessage<ServerError>(HasSubstr("short of disk")));
}

}  // namespace
}  // namespace strata::fleet
