// SPDX-License-Identifier: Apache-2.0
#include "components/bus/service.hpp"

#include <algorithm>
#include <string>

#include "core/base/error.hpp"

namespace strata::bus {
namespace {

constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kPrefixBytes = 16;
constexpr auto kReplyWaits = std::chrono::seconds(2);
/// What is longer goes out once, when the client listens for sure.
constexpr std::size_t kMaxRepeatedBytes = 16'384;
/// How long Cyclone may take from saying that a reader is matched until it hears the writer.
constexpr auto kSettling = std::chrono::milliseconds(150);
/// Clients that ask and never listen must not fill the memory, nor the time of the others.
constexpr std::size_t kMaxWaiting = 256;
constexpr auto kSettlingStep = std::chrono::milliseconds(10);

RawWriter make_writer(const std::shared_ptr<Participant>& participant, const std::string& name,
                      TopicKind kind, const std::string& type, const QosProfile& qos,
                      std::function<void()> on_match) {
  const char* suffix = kind == TopicKind::kRequest ? "_Request" : "_Response";
  return {participant, TopicName(name, kind), type + suffix, qos, std::move(on_match)};
}

QosProfile reply_qos(QosProfile qos) {
  qos.manual_liveliness = true;
  return qos;
}

RawReader make_reader(const std::shared_ptr<Participant>& participant, const std::string& name,
                      TopicKind kind, const std::string& type, const QosProfile& qos,
                      RawReader::Callback callback) {
  const char* suffix = kind == TopicKind::kRequest ? "_Request" : "_Response";
  return {participant, TopicName(name, kind), type + suffix, qos, std::move(callback)};
}

}  // namespace

ServiceRequest read_service_request(const RawMessage& message) {
  const bool has_prefix = vendor_of(message.identity.writer) == kVendorCyclone;
  if (message.cdr.size() < kHeaderBytes + (has_prefix ? kPrefixBytes : 0)) {
    throw InputError("a request to a service",
                     "has " + std::to_string(message.cdr.size()) + " bytes, fewer than its header",
                     "look at the client that sent it");
  }
  ServiceRequest request;
  request.client = message.identity.writer;
  request.is_big_endian = message.cdr[1] == 0;
  request.reply_to = message.identity;
  // A client of Fast DDS may name the reader that waits.
  if (message.related.writer != Guid{}) request.reply_to.writer = message.related.writer;
  if (!has_prefix) {
    request.cdr = message.cdr;
    return request;
  }
  const auto body = message.cdr.begin() + kHeaderBytes;
  request.prefix.emplace();
  std::copy_n(body, kPrefixBytes, request.prefix->begin());
  request.cdr.assign(message.cdr.begin(), body);
  // 16 bytes are a multiple of every alignment, so what follows stays as it is.
  request.cdr.insert(request.cdr.end(), body + kPrefixBytes, message.cdr.end());
  return request;
}

std::vector<std::uint8_t> service_reply_bytes(const ServiceRequest& request,
                                              const std::vector<std::uint8_t>& cdr) {
  if (!request.prefix) return cdr;
  std::array<std::uint8_t, kPrefixBytes> prefix = *request.prefix;
  const bool reply_is_big_endian = cdr[1] == 0;
  if (request.is_big_endian != reply_is_big_endian) {
    std::reverse(prefix.begin(), prefix.begin() + 8);
    std::reverse(prefix.begin() + 8, prefix.end());
  }
  std::vector<std::uint8_t> bytes(cdr.begin(), cdr.begin() + kHeaderBytes);
  bytes.insert(bytes.end(), prefix.begin(), prefix.end());
  bytes.insert(bytes.end(), cdr.begin() + kHeaderBytes, cdr.end());
  return bytes;
}

ServiceServer::ServiceServer(const std::shared_ptr<Participant>& participant,
                             const std::string& name, const std::string& type,
                             const QosProfile& qos, std::function<void(ServiceRequest)> on_request,
                             std::function<void()> on_match)
    : writer_(make_writer(participant, name, TopicKind::kReply, type, reply_qos(qos),
                          std::move(on_match))),
      reader_(make_reader(participant, name, TopicKind::kRequest, type, qos,
                          [on_request = std::move(on_request)](const RawMessage& message) {
                            on_request(read_service_request(message));
                          })) {}

void ServiceServer::reply(const ServiceRequest& request, const std::vector<std::uint8_t>& cdr) {
  const bool is_for_cyclone = request.prefix.has_value();
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  Waiting waiting{service_reply_bytes(request, cdr),
                  request.client,
                  request.reply_to,
                  is_for_cyclone,
                  now,
                  now + kReplyWaits};
  if (is_for_cyclone) {
    Waiting later = waiting;
    later.not_before = settled(request.client);
    const bool is_new = now < later.not_before;
    // At once, and again.
    if (is_new && later.bytes.size() <= kMaxRepeatedBytes) hold(std::move(waiting));
    hold(std::move(later));
  } else {
    hold(std::move(waiting));
  }
  send_what_can_be_sent();
  if (!is_for_cyclone || waiting_.empty()) return;
  if (!later_.joinable()) {
    later_ = std::jthread([this](const std::stop_token& stop) { send_later(stop); });
  }
  changed_.notify_all();
}

void ServiceServer::hold(Waiting waiting) {
  if (waiting_.size() >= kMaxWaiting) waiting_.pop_front();
  waiting_.push_back(std::move(waiting));
}

void ServiceServer::flush() {
  const std::lock_guard lock(mutex_);
  send_what_can_be_sent();
}

void ServiceServer::send_what_can_be_sent() {
  const auto now = std::chrono::steady_clock::now();
  // The topic is volatile: what is sent before the client's reader is matched is lost.
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    if (!writer_.is_matched_with(waiting.client)) return now > waiting.deadline;
    if (now < waiting.not_before) return false;
    // A volatile reader of Cyclone takes all that was published up to the first heartbeat it hears
    // for the past. Fast DDS sends one when it matches, maybe before the reader listens, and the
    // next one behind the reply, which would then be lost.
    if (waiting.is_for_cyclone) writer_.send_heartbeat();
    // One client that does not take its reply is no matter of the others.
    (void)unsent_.run([&] { writer_.publish(waiting.bytes, waiting.related); });
    return true;
  });
}

void ServiceServer::send_later(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (!changed_.wait(lock, stop, [&] { return !waiting_.empty(); })) return;
    changed_.wait_for(lock, stop, kSettlingStep, [] { return false; });
    if (!unsent_.run([&] { send_what_can_be_sent(); })) waiting_.clear();
  }
}

std::chrono::steady_clock::time_point ServiceServer::settled(const Guid& client) {
  const auto now = std::chrono::steady_clock::now();
  std::erase_if(settled_, [&](const auto& entry) {
    return now > entry.second + kReplyWaits && !writer_.is_matched_with(entry.first);
  });
  return settled_.try_emplace(client, now + kSettling).first->second;
}

ServiceClient::ServiceClient(const std::shared_ptr<Participant>& participant,
                             const std::string& name, const std::string& type)
    : writer_(make_writer(participant, name, TopicKind::kRequest, type, qos_profile("default"),
                          nullptr)),
      reader_(make_reader(participant, name, TopicKind::kReply, type, qos_profile("default"),
                          [this](RawMessage message) { take(std::move(message)); })) {}

void ServiceClient::take(RawMessage message) {
  const std::lock_guard lock(mutex_);
  replies_.push_back(std::move(message));
  changed_.notify_all();
}

std::optional<std::vector<std::uint8_t>> ServiceClient::call(
    const std::vector<std::uint8_t>& request, std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  const auto left = [&] {
    return std::chrono::duration_cast<std::chrono::milliseconds>(deadline -
                                                                 std::chrono::steady_clock::now());
  };
  if (!writer_.wait_for_readers(1, left()) || !reader_.wait_for_writers(1, left())) {
    return std::nullopt;
  }
  const Guid own_reader = reader_.guid();
  {
    const std::lock_guard lock(mutex_);
    replies_.clear();
  }
  const std::int64_t number = writer_.publish(request, {own_reader, 0});
  std::unique_lock lock(mutex_);
  const auto is_ours = [&](const RawMessage& reply) {
    return reply.related.writer == own_reader && reply.related.sequence_number == number;
  };
  const auto find = [&] { return std::find_if(replies_.begin(), replies_.end(), is_ours); };
  if (!changed_.wait_until(lock, deadline, [&] { return find() != replies_.end(); })) {
    return std::nullopt;
  }
  return find()->cdr;
}

}  // namespace strata::bus
