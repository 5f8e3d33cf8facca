// Keeps a file with 100,000 faults from printing 100,000 lines.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace pt {

/// Hands on the first warnings of each kind, and of all kinds together, and at its end says how
/// many were left out. Warnings are of a kind where they differ in numbers and quoted names alone.
/// May be called by several threads.
class WarningLimit {
 public:
  using Warn = std::function<void(const std::string&)>;
  static constexpr int most_of_kind = 20, most_in_all = 200;

  explicit WarningLimit(Warn warn) : warn_(std::move(warn)) {}
  ~WarningLimit();
  WarningLimit(const WarningLimit&) = delete;
  WarningLimit& operator=(const WarningLimit&) = delete;

  void operator()(const std::string& message);
  /// For who takes a function; empty where nobody wants to be warned.
  Warn function();

 private:
  const Warn warn_;
  std::mutex mutex_;
  std::map<std::string, int> kinds_;  ///< of those handed on, their number
  std::uint64_t passed_ = 0, left_out_ = 0;
};

}  // namespace pt
