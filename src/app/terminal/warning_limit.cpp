#include "app/terminal/warning_limit.h"

#include <fmt/format.h>

#include <cctype>

namespace pt {
namespace {

/// The message without its numbers and without what stands between quotes.
std::string warning_kind(const std::string& message) {
  std::string kind;
  char quote = 0;
  for (const char c : message.substr(0, 1000)) {
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
      kind += '"';
    } else if (!std::isdigit(static_cast<unsigned char>(c))) {
      kind += c;
    }
  }
  return kind;
}

}  // namespace

WarningLimit::~WarningLimit() {
  if (left_out_ == 0) return;
  try {
    warn_(fmt::format("{} warnings more, of {}; --strict ends at the first", left_out_,
                      passed_ < most_in_all ? "kinds that were shown" : "these and other kinds"));
  } catch (...) {  // what a warning throws was thrown before
  }
}

void WarningLimit::operator()(const std::string& message) {
  {
    const std::lock_guard lock(mutex_);
    if (passed_ >= most_in_all || kinds_[warning_kind(message)] >= most_of_kind) {
      ++left_out_;
      return;
    }
    ++kinds_[warning_kind(message)];
    ++passed_;
  }
  warn_(message);
}

WarningLimit::Warn WarningLimit::function() {
  if (!warn_) return {};
  return [this](const std::string& message) { (*this)(message); };
}

}  // namespace pt
