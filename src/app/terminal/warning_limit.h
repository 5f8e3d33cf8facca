// Limits the warnings about one file, which may have 100,000 faults.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace pt {

/// Forwards the first warnings of each kind and of all kinds together; the destructor tells how
/// many were left out. Warnings of a kind differ only in numbers and quoted names. Thread-safe.
class WarningLimit {
 public:
  using Warn = std::function<void(const std::string&)>;
  static constexpr int most_of_kind = 20, most_in_all = 200;

  explicit WarningLimit(Warn warn) : warn_(std::move(warn)) {}
  ~WarningLimit();
  WarningLimit(const WarningLimit&) = delete;
  WarningLimit& operator=(const WarningLimit&) = delete;

  void operator()(const std::string& message);
  /// This as a function; empty if `warn` is.
  Warn function();

 private:
  const Warn warn_;
  std::mutex mutex_;
  std::map<std::string, int> kinds_;  ///< number of forwarded warnings
  std::uint64_t passed_ = 0, left_out_ = 0;
};

}  // namespace pt
