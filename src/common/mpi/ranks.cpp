#include "common/mpi/ranks.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/distribute/bytes.h"
#include "common/error/error.h"

namespace pt {
namespace {

using namespace std::chrono_literals;

constexpr auto long_wait = 1s;  ///< then look again; the channel ends what takes forever
constexpr auto patience = 5s;   ///< with ranks that do not hear of the end after a failure
}  // namespace

Ranks::Ranks(std::unique_ptr<Channel> channel)
    : channel_(std::move(channel)),
      infos_(channel_->ranks()),
      inbox_(infos_.size()),
      gone_(infos_.size()) {}

void Ranks::send(int to, MessageKind kind, std::string bytes) {
  channel_->send(to, kind, std::make_shared<const std::string>(std::move(bytes)));
}

void Ranks::take(Message&& message) {
  const int from = message.from;
  switch (message.kind) {
    case MessageKind::end:
      end_code_ = ByteReader(message.bytes).number<std::int32_t>();
      return;
    case MessageKind::goodbye:
      gone_[from] = true;
      return;
    case MessageKind::failure:
      if (!failure_) failure_ = infos_[from].name() + ": " + message.bytes;
      return;
    default:
      inbox_[from].push_back(std::move(message));
  }
}

std::optional<Message> Ranks::receive(int from, std::chrono::microseconds wait) {
  const auto find = [&]() -> std::optional<Message> {
    auto& messages = inbox_[from];
    if (failure_) throw Error(*failure_);
    if (messages.empty() && !is_first() && end_code_) throw RanksEnd{*end_code_};
    if (messages.empty()) return std::nullopt;
    Message first = std::move(messages.front());
    messages.pop_front();
    return first;
  };
  const auto until = std::chrono::steady_clock::now() + wait;
  for (;;) {
    while (auto message = channel_->receive(0us)) take(std::move(*message));
    if (auto message = find()) return message;
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(
        until - std::chrono::steady_clock::now());
    if (left <= 0us) return std::nullopt;
    if (auto message = channel_->receive(left)) take(std::move(*message));
  }
}

Message Ranks::expect(int from, MessageKind kind) {
  for (;;) {
    std::optional<Message> message = receive(from, long_wait);
    if (!message) continue;
    if (message->kind == kind) return std::move(*message);
    throw Error(fmt::format("a message of kind {} from {}: expected one of kind {}",
                            static_cast<int>(message->kind), infos_[from].name(),
                            static_cast<int>(kind)));
  }
}

/// Rank 0: until the others need nothing more of it.
void Ranks::dismiss() {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (std::count(gone_.begin() + 1, gone_.end(), false) > 0) {
    if (failure_ && !is_reported_) throw Error(*failure_);
    if (is_reported_ && std::chrono::steady_clock::now() > until) channel_->abort(*end_code_);
    if (auto message = channel_->receive(100ms)) take(std::move(*message));
  }
  for (int to = 1; to < count(); ++to) send(to, MessageKind::closing);
}

/// Another rank: after the end.
void Ranks::say_goodbye() {
  send(0, MessageKind::goodbye);
  const auto is_closing = [](const Message& m) { return m.kind == MessageKind::closing; };
  while (std::ranges::none_of(inbox_[0], is_closing)) {
    if (auto message = channel_->receive(long_wait)) take(std::move(*message));
  }
}

int Ranks::finish(int code) {
  if (is_closed_) return end_code_.value_or(code);
  if (is_first()) {
    if (!end_code_) {
      end_code_ = code;
      ByteWriter writer;
      writer.number(static_cast<std::int32_t>(code));
      const auto bytes = std::make_shared<const std::string>(writer.take());
      for (int to = 1; to < count(); ++to) channel_->send(to, MessageKind::end, bytes);
    } else if (code != 0) {
      end_code_ = code;
    }
    dismiss();
  } else {
    while (!end_code_) {
      if (auto message = channel_->receive(long_wait)) take(std::move(*message));
    }
    say_goodbye();
  }
  channel_->close(*end_code_);
  is_closed_ = true;
  return *end_code_;
}

int Ranks::fail(const std::string& message, int code,
                const std::function<void(const std::string&)>& report) {
  if (is_first()) {
    report(message);
    is_reported_ = true;
    return finish(code);
  }
  send(0, MessageKind::failure, message);
  const int end = finish(code);
  return end != 0 ? end : code;
}

}  // namespace pt
